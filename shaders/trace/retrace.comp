// Traces the links that retrace_mark.comp has listed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/pairs.glsl"
#include "lib/sampling.glsl"
#include "shared_objects.h"
layout(push_constant, scalar) uniform Push { RetracePush push; };
#define geometry push.geometry
#include "lib/rays/trace.glsl"
#include "lib/link.glsl"
#include "lib/rays/boxes.glsl"
#include "lib/rays/retrace.glsl"

layout(local_size_x = 64) in;

void main() { retraceLinks(gl_GlobalInvocationID.x, gl_NumWorkGroups.x * kChunk); }
