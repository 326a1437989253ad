#version 450
// passes/display.comp — the picture so far as the screen takes it: exposure and tone curve.
#include "lib/tone.glsl"
#include "shared/view_block.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_PICTURE) uniform sampler2D picture; // linear radiance
layout(binding = TARN_IMAGE_SCREEN, rgba8) uniform writeonly image2D screen;

layout(location = 0) uniform vec2 factors; // x: exposure, y: what is there is this share of the picture, as a factor

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(screen))))
        return;
    vec3 colour = tone_curve(into_gamut(texelFetch(picture, pixel, 0).rgb * factors.y), factors.x);
    // 4 x 4 Bayer thresholds against banding, as src/image/tone.cpp.
    const int bayer[16] = int[16](0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);
    float dither = (float(bayer[(pixel.y % 4) * 4 + pixel.x % 4]) + 0.5) / 16.0 - 0.5;
    imageStore(screen, pixel, vec4(clamp(colour + dither / 255.0, 0.0, 1.0), 1.0));
}
