#pragma once

// Embree 3 and 4 behind one set of names: where the two differ, and nothing else.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relume {

#if RTC_VERSION_MAJOR >= 4

struct EmbreeOccludedQuery {
    RTCOccludedArguments arguments;
    EmbreeOccludedQuery() {
        rtcInitOccludedArguments(&arguments);
        arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    }
};
inline void embreeOccluded(const int* valid, RTCScene scene, EmbreeOccludedQuery& query, RTCRay8& rays) {
    rtcOccluded8(valid, scene, &rays, &query.arguments);
}

struct EmbreeIntersectQuery {
    RTCIntersectArguments arguments;
    EmbreeIntersectQuery() { rtcInitIntersectArguments(&arguments); }
};
inline void embreeIntersect(const int* valid, RTCScene scene, EmbreeIntersectQuery& query, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &rays, &query.arguments);
}

#else

struct EmbreeOccludedQuery {
    RTCIntersectContext context;
    EmbreeOccludedQuery() {
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
};
inline void embreeOccluded(const int* valid, RTCScene scene, EmbreeOccludedQuery& query, RTCRay8& rays) {
    rtcOccluded8(valid, scene, &query.context, &rays);
}

struct EmbreeIntersectQuery {
    RTCIntersectContext context;
    EmbreeIntersectQuery() { rtcInitIntersectContext(&context); }
};
inline void embreeIntersect(const int* valid, RTCScene scene, EmbreeIntersectQuery& query, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &query.context, &rays);
}

#endif

} // namespace relume
