#version 450 core
// passes/prism_corners.comp — corners of the prisms of light below a moving surface: where a grid on it sends the sun's
// light. Reads waves; writes prisms and shares. One invocation a corner.
// Source: the grid about the sun's image is that of Lanza (2007), "Animation and Rendering of Underwater God Rays",
// ShaderX5; see docs/physics/caustics.md.
#include "shared/view_block.h"
#include "shared/prisms.h"
#include "lib/waves.glsl"
#include "lib/caustics.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = TARN_BLOCK_VIEW, std140) uniform View { ViewBlock view; };
layout(binding = TARN_BLOCK_WAVES, std140) uniform Waves { WaveBlock waves; };
layout(binding = TARN_TEXTURE_SLOPES) uniform sampler2DArray wave_slope_layers;
layout(binding = TARN_TEXTURE_AMPLITUDE) uniform sampler2D amplitudes;
layout(binding = TARN_TEXTURE_WAVE_TABLE) uniform sampler2D wave_table;
layout(binding = TARN_BUFFER_PRISMS, std430) writeonly buffer Prisms { vec4 corners[]; };
layout(binding = TARN_BUFFER_SHARES, std430) writeonly buffer Shares { float shares[]; };
layout(location = 0) uniform vec4 grid; // xy: first corner [m], z: spacing [m], w: corners a side
layout(location = 1) uniform float camera_depth_m;

void main() {
    ivec2 corner = ivec2(gl_GlobalInvocationID.xy);
    int side = int(grid.w);
    if (any(greaterThanEqual(corner, ivec2(side))))
        return;
    vec2 at_m = grid.xy + grid.z * vec2(corner);
    vec4 amplitude = wave_fade(waves, camera_depth_m) * wave_amplitude(amplitudes, waves, at_m);
    vec3 taken;
    vec2 slope = wave_slopes(wave_slope_layers, wave_table, waves, at_m, 0.5 * grid.z, amplitude, taken);
    bool schlick = (view.counts.z & TARN_FLAG_SCHLICK) != 0u;
    Photon photon = photon_below(view.sun.xyz, slope, view.optics.x, schlick);
    Photon flat_water = photon_below(view.sun.xyz, vec2(0.0), view.optics.x, schlick);
    // By the grid's border the surface is flat: outside of it no light is added or taken.
    vec2 off = abs(vec2(corner) / float(side - 1) * 2.0 - 1.0);
    float inside = 1.0 - smoothstep(0.7, 1.0, max(off.x, off.y));
    int i = corner.y * side + corner.x;
    corners[i] = vec4(at_m, mix(flat_water.lean, photon.lean, photon.share > 0.0 ? inside : 0.0));
    shares[i] = mix(1.0, photon.share, inside);
}
