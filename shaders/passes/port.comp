#version 450 core
// passes/port.comp — how high the moving water stands behind and before the port of a camera at its surface: a square
// about the camera, 64 texels a side (lib/parts.glsl, camera_part). Reads heights and waves; writes port heights,
// metres above z = 0. One invocation a texel. Calm water needs none of it: the renderer fills in the level.
#include "lib/heightfield.glsl"
#include "lib/waves.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_TEXTURE_HEIGHTS) uniform sampler2D heights;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };
layout(binding = TARN_TEXTURE_WAVES) uniform sampler2DArray wave_heights;
layout(binding = TARN_TEXTURE_AMPLITUDE) uniform sampler2D amplitudes;
layout(binding = TARN_TEXTURE_WAVE_TABLE) uniform sampler2D wave_table;
layout(binding = TARN_IMAGE_BEAMS, r32f) uniform writeonly image2D port_heights;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    vec2 across = (vec2(texel) + 0.5) / float(TARN_PORT_SIDE) * 2.0 - 1.0;
    vec2 nodes = view.camera.xy + across * view.diver.x * view.base.z; // from view.base
    vec2 cell = clamp(floor(nodes + view.base.xy), vec2(0.0), view.grid.xy - 2.0);
    vec4 ground = textureGather(heights, (cell + 1.0) * view.inverse_size.xy, 0) * view.heights.y;
    float depth = view.options.y - bilinear(ground, clamp(nodes + view.base.xy - cell, 0.0, 1.0));
    vec2 at_m = nodes * vec2(view.grid.z, -view.grid.z);
    vec4 amplitude = wave_fade(waves, depth) * wave_amplitude(amplitudes, waves, at_m);
    imageStore(port_heights, texel, vec4(view.options.y + wave_height(wave_heights, wave_table, waves, at_m, 0.0, amplitude)));
}
