// lib/walks/meet_waves.glsl — where a ray meets the moving water, once it has come to the slab that holds it.
//
// The walk for the calm surface brings the ray to the slab's border (the level raised by the waves' bound,
// wave_block.h `lift`, or lowered by it from below). From there it goes from cell to cell of the ground's
// grid; inside one, ground, level and depth are known along the ray in closed form, and the waves are
// approached in steps that they cannot rise through: gap over the closing speed, which the steepest slope
// there is bounds (sphere tracing, Hart 1996; the safety radius of Baboud & Decoret for a dynamic surface).
// Source  as said; limits from passes/wave_levels.comp, of the waves at this moment.
// Fails   crests thinner than a tenth of a pixel's footprint, the shortest step, may be passed; a ray that has made 2048 steps in one cell
//         without meeting anything goes on with the next cell.
#include "lib/heightfield.glsl"
#include "lib/waves.glsl"

// A cell may be tens of metres wide and a step close to the eye a centimetre. Far fewer are usual: 8 to 12.
const int most_steps = 2048;
const int met_nothing = 0, met_ground = 1, met_water = 2;

// wave_footprint — width of the filter for heights and slopes seen in a pixel: the geometric mean of the
//                  pixel's footprint across and along the view on level water.
float wave_footprint(float pixel_rad, float path_m, float sink) { return pixel_rad * path_m * inversesqrt(max(abs(sink), 0.02)); }

// wave_bounds — greatest |height| and steepest slope of each cascade at full amplitude, and the mip level for a
//               footprint.
void wave_bounds(usamplerBuffer limits, WaveBlock waves, float footprint_m, out vec4 high, out vec4 steep, out vec4 levels) {
    high = vec4(0.0);
    steep = vec4(0.0);
    levels = vec4(0.0);
    for (int j = 0; j < TARN_CASCADES; ++j) {
        // Whole levels: one mip level to look up. What that moves is less than a pixel; slopes stay smooth.
        levels[j] = floor(wave_level(waves, j, footprint_m) + 0.5);
        int level = int(min(levels[j], float(TARN_WAVE_LEVELS - 1)));
        high[j] = uintBitsToFloat(texelFetch(limits, j * TARN_WAVE_LIMITS + level).r);
        float filtered = 2.83 * high[j] / (waves.patches[j].w * float(1 << level)); // between texels of that level
        steep[j] = min(uintBitsToFloat(texelFetch(limits, j * TARN_WAVE_LIMITS + TARN_WAVE_LEVELS).r), filtered);
    }
}

// meet_waves — from path length `t` on.
//
//   side     +1 from the air, -1 from the water
//   to_m     factor: texel units to metres
//   t_left   where the ray has left the slab, if it met nothing
int meet_waves(sampler2D heights, sampler2DArray wave_heights, sampler2D amplitudes, sampler2D table, usamplerBuffer limits,
               Field field, WaveBlock waves, vec2 base, float pixel_rad, Ray ray, float side, float t_end, out Hit hit,
               out float t_left) {
    t_left = t_end;
    Span span;
    if (!clip_ray(field, ray, t_end, span))
        return met_nothing;
    float to_m = 1.0 / field.per_m, spacing = 1.0 / field.per_spacing, lift = waves.counts.w;
    vec2 cell = cell_at(span, span.t);
    float t = span.t;
    float pace = length(span.d) * spacing; // metres along the ground a metre of path
    int dry = 0;
    for (int steps = int(field.cells.x + field.cells.y) + 8; steps >= 0; --steps) {
        vec2 t_border = borders(span, cell);
        float t_out = max(t, min(min(t_border.x, t_border.y), span.t_end)), sink = climb_of(ray, t);
        vec2 middle = (cell + ray.base + 1.0) * field.texel;
        vec4 ground = textureGather(heights, middle, 0), water = textureGather(heights, middle, 1);
        bool wet = min(min(water.x, water.y), min(water.z, water.w)) > 0.0;
        water = water * field.water.y + (field.water.x - lift * field.per_m);
        vec2 corner = span.o - cell;
        vec2 p_in = clamp(corner + t * span.d, 0.0, 1.0), p_out = clamp(corner + t_out * span.d, 0.0, 1.0);
        float bend = -(p_out.x - p_in.x) * (p_out.y - p_in.y), z_in = height_at(span, t), z_out = height_at(span, t_out);
        float sag = sag_between(span, t, t_out);
        Gap over_ground = Gap(z_in - bilinear(ground, p_in), z_out - bilinear(ground, p_out), bend * twist(ground) + sag);
        Gap over_level = Gap(z_in - bilinear(water, p_in), z_out - bilinear(water, p_out), bend * twist(water) + sag);
        over_level = Gap(over_level.above * to_m, over_level.below * to_m, over_level.curve * to_m);
        float s_ground = first_crossing(over_ground), s_stop = min(s_ground, 1.0);
        if (wet) {
            // By the cell: near the horizon a pixel's footprint grows along the way.
            float footprint = wave_footprint(pixel_rad, max(t, 0.1), sink), near = max(0.2 * footprint, 1e-4);
            vec4 high, steep, levels;
            wave_bounds(limits, waves, footprint, high, steep, levels);
            float tilt = over_level.below - over_level.above - over_level.curve;
            Gap to_bed = Gap(over_ground.above * to_m, over_ground.below * to_m, over_ground.curve * to_m);
            float bed_tilt = to_bed.below - to_bed.above - to_bed.curve;
            vec2 at_in = (cell + ray.base - base + p_in) * spacing, at_out = (cell + ray.base - base + p_out) * spacing;
            at_in.y = -at_in.y;
            at_out.y = -at_out.y;
            vec4 a_in = wave_amplitude(amplitudes, waves, at_in), a_out = wave_amplitude(amplitudes, waves, at_out);
            float depth_in = to_bed.above - over_level.above, depth_out = to_bed.below - over_level.below;
            vec4 most = max(a_in, a_out);
            float most_fade = max(wave_fade(waves, depth_in), wave_fade(waves, depth_out));
            // What the cascades after the first, after the second, ... can still add to the height; and how
            // fast the gap to those before can close over s in [0, 1]: by the ray, the waves, the fade, the map.
            vec4 tops = most * high;
            vec4 rest = vec4(tops.y + tops.z + tops.w, tops.z + tops.w, tops.w, 0.0) * most_fade;
            float sines = most.x * waves.counts.y, reach = (tops.x + sines) * most_fade + rest.x;
            float calm_closing = max(abs(tilt), abs(tilt + 2.0 * over_level.curve));
            float stretch = pace * (t_out - t), thinning = (abs(bed_tilt - tilt) + 2.0 * abs(to_bed.curve - over_level.curve)) / waves.shore.x;
            vec4 closing = most * (steep * (most_fade * stretch) + high * thinning) + abs(a_out - a_in) * high;
            closing.x += calm_closing + most.x * (waves.counts.z * most_fade * stretch + waves.counts.y * thinning);
            closing.y += closing.x;
            closing.z += closing.y;
            closing.w += closing.z;
            // Too low to be seen: a plane.
            float s = reach < near ? first_crossing(Gap(side * over_level.above, side * over_level.below, side * over_level.curve)) : 0.0;
            bool met = s > 0.0 && s <= s_stop;
            float last_gap = 0.0, last_s = 0.0;
            for (int i = 0; i < most_steps && s < s_stop && !met; ++i) {
                float level_gap = over_level.above + s * (tilt + s * over_level.curve);
                float stride = (side * level_gap - reach) / calm_closing; // above the highest wave
                if (stride <= 0.0) {
                    float depth = to_bed.above + s * (bed_tilt + s * to_bed.curve) - level_gap;
                    vec4 amplitude = wave_fade(waves, depth) * mix(a_in, a_out, s);
                    vec2 at = mix(at_in, at_out, s);
                    float gap = side * level_gap - side * sine_height(table, waves, at, footprint, amplitude.x);
                    // Cascade by cascade, while what is known of the height is too little for a step.
                    stride = 0.0;
                    for (int j = 0; j < max(TARN_CASCADES, 1); ++j) {
                        if (TARN_CASCADES > 0)
                            gap -= side * amplitude[j] * cascade_height(wave_heights, waves, j, at, levels[j]);
                        stride = max(stride, (gap - rest[j]) / closing[j]);
                        met = gap <= 0.0 && j >= TARN_CASCADES - 1;
                        if (met || gap - rest[j] > rest[j])
                            break;
                    }
                    if (met) { // between the last step and this one: where a straight line says
                        s = last_gap > 0.0 ? mix(last_s, s, last_gap / (last_gap - gap)) : s;
                        break;
                    }
                    last_gap = gap;
                    last_s = s;
                }
                s += max(stride, 0.5 * near / closing.x);
            }
            if (met) {
                hit = Hit(t + s * (t_out - t), true, ivec2(cell + ray.base), clamp(mix(p_in, p_out, s), 0.0, 1.0));
                return met_water;
            }
        }
        if (s_ground <= 1.0) {
            hit = Hit(t + s_ground * (t_out - t), false, ivec2(cell + ray.base), clamp(mix(p_in, p_out, s_ground), 0.0, 1.0));
            return met_ground;
        }
        t_left = t_out;
        if (t_out >= span.t_end)
            return met_nothing;
        // Out of the slab: upwards in the air, downwards in the water; or over land for good (a ray that comes to
        // the slab at a border may be taken to be in the dry cell before it).
        dry = wet ? 0 : dry + 1;
        if (side * sink > 0.0 && (dry > 2 || (wet && side * over_level.below > lift)))
            return met_nothing;
        t = t_out;
        cell = beyond(span, cell, t_border);
    }
    return met_nothing;
}
