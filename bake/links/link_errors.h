#pragma once

#include "bake/base/local_error.h"
#include "bake/gather/chunk_plan.h"
#include "bake/gather/link_kit.h"
#include "bake/links/link_schedule.h"

namespace relume {

/// Makes the result of a link solver from its sums, and finds how far it is off. Where several ranks bake,
/// each makes it of its own chunks, and all learn what all of them say; so all make the same calls.
class LinkErrors {
public:
    explicit LinkErrors(LinkKit& kit);

    /// Makes the result after the state's sample passes, smoothed by sigma [texels]. Returns what sums over
    /// all patches say.
    shader::ResolveSums resolve(const LinkState& state, double sigma) const;
    /// What the last resolve() says of local error.
    struct Local {
        double median = 0; // light of all texels [cd/m^2]
        LocalError error;
        double direct = 0,
               links = 0; // variances, relative to what local error is relative to: all texels' sum
    };
    Local local() const;
    /// Returns what the last resolve() says of each chunk.
    std::vector<ChunkVariance> chunks() const;
    /// Returns the variance that interpolation from a coarser grid leaves, R, G and B of so many patches
    /// together: a share of how far the receivers themselves are from what their neighbours say.
    double coarseVariance(const LinkState& state, double patches) const;
    /// Compares the light of a bounce with the one before. Returns the sums over all patches as ChangePush
    /// has them.
    glm::dvec4 change(bool isFirst) const;
    /// Does so on the CPU, and makes what patches send of the light that came; full is as HostSend has it.
    glm::dvec4 sendOnHost(const std::vector<uint8_t>& full, bool isFirst) const;

private:
    void resolveOnHost(const LinkState& state, double sigma) const;
    std::vector<shader::LocalSums> localSums() const; // per chunk, of all ranks
    template<typename T>
    std::vector<T> chunkSums() const; // likewise

    LinkKit& kit_;
    ResolvePass pass_;
    std::vector<uint8_t> shown_; // per chunk: texels that are shown
    std::vector<uint8_t> own_;   // per chunk: 1 if this rank's; empty: all are
};

} // namespace relume
