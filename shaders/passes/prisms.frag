#version 450 core
// passes/prisms.frag — what a face of a prism of light adds to what a view looks through: light up to here where the
// view leaves the prism, less light up to here where it enters. Added up over all faces.
// Reads prism rays; the target's texels cover TARN_PRISM_PIXELS squared of the picture.
#include "shared/prisms.h"

layout(binding = TARN_IMAGE_PRISM_RAYS, rgba32f) uniform readonly image2D rays;
layout(location = 0) in vec3 from_eye;
layout(location = 1) flat in float strength;
layout(location = 0) out float light;

void main() {
    vec4 ray = imageLoad(rays, ivec2(gl_FragCoord.xy));
    float t = min(length(from_eye), ray.x);
    float up_to_here = abs(ray.y * t) < 1e-3 ? t : (1.0 - exp(clamp(-ray.y * t, -60.0, 60.0))) / ray.y;
    // Rows go down, so faces are turned about: the ones that look at the eye are GL's back faces.
    light = (gl_FrontFacing ? 1.0 : -1.0) * strength * up_to_here * ray.z;
}
