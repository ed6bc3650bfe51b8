#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace relume::shader {
using namespace glm; // GLSL's names: vec3, uint, dot, ...
using glm::uint;
#ifdef RELUME_INLINE_SHADERS // loops that are to become vector code must not call
#define FUNCTION [[gnu::always_inline]] inline
#else
#define FUNCTION inline
#endif
#define INOUT(T) T&
#include "shaders/shared.h"
#include "shaders/lib/patch_flags.glsl"
#include "shaders/lib/pairs.glsl"
#include "shaders/lib/form_factor.glsl"
#include "shaders/lib/sampling.glsl"
#include "shaders/lib/rays/start_point.glsl"
#include "shaders/lib/light/texel_mean.glsl"
#include "shaders/lib/light/polygon_sample.glsl"
#include "shaders/lib/light/emitters.glsl"
#include "shaders/lib/light/lamps.glsl"
#include "shaders/lib/light/seen_light.glsl"
#include "shaders/lib/footprint.glsl"
#include "shaders/lib/units.glsl"
#include "shaders/lib/packed_light.glsl"
#include "shaders/lib/relative_change.glsl"
#include "shaders/lib/seams.glsl"
#include "shaders/lib/local_error.glsl"
#include "shaders/lib/sketch.glsl"

static_assert(sizeof(Patch) == 48 && sizeof(PatchEdges) == 24 && sizeof(ChunkBounds) == 28);
static_assert(sizeof(PatchCover) == 32 && sizeof(ClosestPush) <= 128 && sizeof(SegmentPush) <= 128);
static_assert(sizeof(SuperBlock) == 56 && sizeof(Sender) == 12);
static_assert(sizeof(OcclusionPush) <= 128 && sizeof(GatherPush) <= 128); // what every device takes
static_assert(sizeof(HitTriangle) == 48 && sizeof(AlphaTriangle) == 40 && sizeof(AlphaMaterial) == 28);
static_assert(sizeof(EmitterPolygon) == 80 && sizeof(EmitterNode) == 48);
static_assert(sizeof(EmitterEdge) == 64 && sizeof(EmitterSamplesPush) <= 128);
static_assert(sizeof(Lamp) == 92 && sizeof(LampPush) <= 128);
static_assert(sizeof(CoarseTaps) == 32 && sizeof(CoarseNeighbours) == 28);
static_assert(sizeof(PyramidNode) == 52);
static_assert(sizeof(BvhNode) == 48 && sizeof(BvhTriangle) == 48);
static_assert(sizeof(VoxelGrid) == 64 && sizeof(CvmPush) <= 128);
} // namespace relume::shader
