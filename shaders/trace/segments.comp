// Traces segments from patches to targets of their own, with one workgroup per chunk (x) and word of targets
// (y), one invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/pairs.glsl"
#include "lib/sampling.glsl"
layout(push_constant, scalar) uniform Push { SegmentPush push; };
#define geometry push.geometry
#include "lib/rays/trace.glsl"
#ifdef TRACER_VOXEL
#include "lib/rays/segments.glsl"
#else
#include "lib/rays/numbered_segments.glsl"
#endif

layout(local_size_x = 64) in;

void main() { traceTargets(gl_WorkGroupID.x, gl_WorkGroupID.y, gl_LocalInvocationID.x); }
