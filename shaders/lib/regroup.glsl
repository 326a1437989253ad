// lib/regroup.glsl — rays that are not done after a first stretch change places, so that those which go on
// stand beside each other and the rest of the workgroup is free. GPUs run 32 rays in step: one that
// flies on keeps 31 waiting. Only where TARN_REGROUP is defined (not for software GL).
// The one library with shared memory: a pass has one workgroup, this is its layout.

#ifdef TARN_REGROUP
layout(local_size_x = 256) in;
shared uint regroup_count;
shared uvec2 regroup_list[256];

// regroup_pixel — this invocation's pixel: warps cover 8 x 4, workgroups 16 x 16.
ivec2 regroup_pixel() {
    int i = int(gl_LocalInvocationIndex);
    ivec2 tile = ivec2((i >> 6) & 1, i >> 7) * 8;
    return ivec2(gl_WorkGroupID.xy) * 16 + tile + ivec2(i & 7, (i >> 3) & 7);
}

// regroup_begin — before the first stretch.
void regroup_begin() {
    if (gl_LocalInvocationIndex == 0u)
        regroup_count = 0u;
    barrier();
}

// regroup_wait — this invocation's ray goes on from t.
void regroup_wait(float t) {
    regroup_list[atomicAdd(regroup_count, 1u)] = uvec2(gl_LocalInvocationIndex, floatBitsToUint(t));
}

// regroup_next — after the first stretch, by all invocations: the pixel to go on with, if any.
bool regroup_next(out ivec2 pixel, out float t) {
    barrier();
    if (gl_LocalInvocationIndex >= regroup_count)
        return false;
    uvec2 entry = regroup_list[gl_LocalInvocationIndex];
    int i = int(entry.x);
    ivec2 tile = ivec2((i >> 6) & 1, i >> 7) * 8;
    pixel = ivec2(gl_WorkGroupID.xy) * 16 + tile + ivec2(i & 7, (i >> 3) & 7);
    t = uintBitsToFloat(entry.y);
    return true;
}
#else
layout(local_size_x = 8, local_size_y = 8) in;
ivec2 regroup_pixel() { return ivec2(gl_GlobalInvocationID.xy); }
#endif
