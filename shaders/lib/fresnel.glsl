// lib/fresnel.glsl — what happens to light at a smooth water surface.
// Pure functions: no uniforms, no textures, no built-in inputs. C++ twin: src/reference/fresnel.hpp

// fresnel_dielectric — unpolarised reflectance of a smooth interface between two dielectrics.
//
//   cos_i    cosine between the normal and the incident direction, in [0, 1]
//   eta      n(incident side) / n(far side), > 0; air to water is about 0.75, water to air 1.33
//   returns  reflected fraction of the power, in [0, 1]; exactly 1 beyond the critical angle
//
// Accuracy within 1e-6 of the exact value for some eta within four float32 roundings of the one
//          given; looser only at the critical angle (tests/gpu/fresnel_gpu_test.cpp).
// Source   Fresnel's equations in cosine form (Born & Wolf, Principles of Optics, sec. 1.5.2).
float fresnel_dielectric(float cos_i, float eta) {
    float sin2_t = eta * eta * (1.0 - cos_i * cos_i); // Snell
    if (sin2_t >= 1.0)
        return 1.0; // total internal reflection
    float cos_t = sqrt(1.0 - sin2_t);
    float r_s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    float r_p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// fresnel_schlick — the usual approximation; off by up to +.059 near 83.8 degrees.
//
//   same arguments; from the denser side it is given the angle on the thinner side, without which
//   it would know nothing of total reflection.
// Source   Schlick (1994), An inexpensive BRDF model, eq. 15.
float fresnel_schlick(float cos_i, float eta) {
    float r0 = (eta - 1.0) / (eta + 1.0);
    r0 *= r0;
    float cosine = cos_i;
    if (eta > 1.0) {
        float sin2_t = eta * eta * (1.0 - cos_i * cos_i);
        if (sin2_t >= 1.0)
            return 1.0;
        cosine = sqrt(1.0 - sin2_t);
    }
    float m = 1.0 - cosine;
    return r0 + (1.0 - r0) * m * m * m * m * m;
}

// refracted — direction of the ray that passes a surface.
//
//   direction  unit, not beyond the critical angle
//   normal     unit, on the side that the ray comes from
//   eta        n(incident side) / n(far side)
vec3 refracted(vec3 direction, vec3 normal, float eta) {
    float cosine = -dot(direction, normal);
    vec3 flat_part = eta * (direction + cosine * normal); // Snell: the part along the surface scales by eta
    return flat_part - sqrt(max(0.0, 1.0 - dot(flat_part, flat_part))) * normal;
}
