#include "assets/atlas/chart_join.h"

#include "assets/atlas/chart_flatten.h"
#include "assets/base/numbering.h"
#include "assets/base/worker_pool.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace relume {

namespace {

constexpr double kHardCosine = 0.5; // 60 degrees: light is not filtered across what bends more
constexpr double kNarrow = 1.5; // [texels]: a chart so narrow shares its texels with its neighbours anyway
constexpr double kLeastShared = 0.08; // of the shorter border: two that touch less only make a bulky chart
constexpr double kSameShape = 2e-4;   // mismatch of a common border over its length, for a rigid motion
constexpr double kLikeShape = 0.12;   // likewise, to be worth a relaxation
constexpr double kSmallPart = 0.25;   // of the other's area: a plane so small may be bent with it
constexpr size_t kMostHinges = 4;     // edges of a seam, the longest, along which planes are unfolded
constexpr uint32_t kMostRounds = 64;
constexpr size_t kMostRelaxed = 16384; // triangles; two charts this large gain little by becoming one

/// Holds an edge between two charts: a half-edge of the one of lower number.
struct Seam {
    uint32_t a, b, halfEdge;
};

/// Holds two charts that may be joined, with the seams between them.
struct Candidate {
    uint32_t a, b;
    size_t first, last; // of the seams
    double score;       // share of the shorter border that goes away
    bool narrow;        // one of them is
};

struct Refused {
    uint32_t a, b, versionA, versionB;
};

/// Holds what two charts become.
struct Joined {
    FlatChart chart;
    std::vector<glm::dvec2> uv;  // 3 per triangle
    std::vector<uint32_t> glued; // half-edges, one of each edge
};

/// Turns and moves a plane: p -> (c p.x - s p.y, s p.x + c p.y) + move.
struct Motion {
    double c = 1.0, s = 0.0;
    glm::dvec2 move{0.0};
    glm::dvec2 operator()(const glm::dvec2& p) const {
        return glm::dvec2(c * p.x - s * p.y, s * p.x + c * p.y) + move;
    }
};

/// Holds two positions of a vertex in its charts' planes.
struct Match {
    glm::dvec2 here, there;
    double weight;
};

/// Returns the rigid motion that takes `there` to `here` with the least squares.
Motion fitMotion(const std::vector<Match>& matches) {
    glm::dvec2 here(0.0), there(0.0);
    double weight = 0.0;
    for (const Match& match : matches) {
        here += match.weight * match.here;
        there += match.weight * match.there;
        weight += match.weight;
    }
    here /= weight;
    there /= weight;
    Motion motion;
    double c = 0.0, s = 0.0;
    for (const Match& match : matches) {
        const glm::dvec2 p = match.there - there, q = match.here - here;
        c += match.weight * (p.x * q.x + p.y * q.y);
        s += match.weight * (p.x * q.y - p.y * q.x);
    }
    const double length = std::sqrt(c * c + s * s);
    if (length > 0.0) {
        motion.c = c / length;
        motion.s = s / length;
    }
    motion.move = here - motion(there);
    return motion;
}

class Joiner {
public:
    Joiner(const WeldedMesh& mesh, double texel, WorkerPool& pool, ChartSet& set);
    void run();

private:
    /// Holds how a seam fits: its half-edges on the side that stays, their length, and how far their ends are
    /// apart.
    struct Fit {
        std::vector<uint32_t> run;
        Motion motion;
        double length, mismatch;
        bool isRigid() const { return mismatch <= kSameShape * length; }
    };
    void findSeams();
    std::vector<Candidate> candidates();
    bool isCrease(uint32_t halfEdge) const;
    bool isSmooth(uint32_t halfEdge) const;
    std::optional<Candidate> candidateOf(size_t first, size_t last) const;
    std::vector<Candidate> choose(const std::vector<Candidate>& all) const;
    Fit fit(const Candidate& candidate, bool swapped, std::vector<uint32_t> run) const;
    std::optional<Joined> attempt(const Candidate& candidate);
    std::vector<uint32_t> longestRun(const Candidate& candidate, bool swapped) const;
    Match matchOf(uint32_t halfEdge, bool atEnd) const;
    double mismatch(uint32_t halfEdge, const Motion& motion) const;
    bool mayRelax(const FlatChart& large, const FlatChart& small) const;
    std::optional<Joined> glue(const FlatChart& large, const FlatChart& small, std::vector<uint32_t> seam,
                               const Motion& motion, bool relax);
    void apply(const Candidate& candidate, Joined& joined);
    double lengthOf(uint32_t halfEdge) const {
        return glm::distance(mesh_.corners[halfEdge], mesh_.corners[WeldedMesh::nextCorner(halfEdge)]);
    }
    bool isRefused(uint32_t a, uint32_t b) const;

    const WeldedMesh& mesh_;
    const double texel_;
    WorkerPool& pool_;
    ChartSet& set_;
    std::vector<uint32_t> chartOf_, version_, slot_;
    std::vector<uint32_t> open_; // half-edges between charts, the lower one of each edge
    std::vector<Seam> seams_;
    std::vector<Refused> refused_; // sorted
    std::vector<uint8_t> edging_;  // per triangle: it came to its chart as a narrow one
};

Joiner::Joiner(const WeldedMesh& mesh, double texel, WorkerPool& pool, ChartSet& set)
    : mesh_(mesh), texel_(texel), pool_(pool), set_(set), chartOf_(mesh.triangleCount(), kNoNumber),
      version_(set.charts.size()), slot_(mesh.triangleCount()), edging_(mesh.triangleCount()) {
    for (uint32_t i = 0; i < set.charts.size(); ++i)
        for (uint32_t t : set.charts[i].triangles)
            chartOf_[t] = i;
    for (uint32_t h = 0; h < mesh.corners.size(); ++h)
        if (mesh.opposite[h] != kNoNumber && h < mesh.opposite[h] && !set.glued[h]) open_.push_back(h);
}

void Joiner::findSeams() {
    seams_.clear();
    size_t kept = 0;
    for (uint32_t h : open_) {
        const uint32_t other = mesh_.opposite[h], a = chartOf_[h / 3], b = chartOf_[other / 3];
        if (a == b) continue; // they never come apart again
        open_[kept++] = h;
        if (a < b)
            seams_.push_back({a, b, h});
        else
            seams_.push_back({b, a, other});
    }
    open_.resize(kept);
    std::sort(seams_.begin(), seams_.end(), [](const Seam& l, const Seam& r) {
        if (l.a != r.a) return l.a < r.a;
        return l.b != r.b ? l.b < r.b : l.halfEdge < r.halfEdge;
    });
}

bool Joiner::isRefused(uint32_t a, uint32_t b) const {
    const auto found = std::lower_bound(
        refused_.begin(), refused_.end(), Refused{a, b, 0, 0},
        [](const Refused& l, const Refused& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; });
    return found != refused_.end() && found->a == a && found->b == b && found->versionA == version_[a] &&
           found->versionB == version_[b];
}

bool Joiner::isCrease(uint32_t h) const {
    return glm::dot(mesh_.normal[h / 3], mesh_.normal[mesh_.opposite[h] / 3]) <= kHardCosine;
}

/// Tells whether wide charts may be joined across an edge. What came to a chart as a narrow one leads
/// nowhere: else a thin wall would have its two sides, one in the sun and one in the dark, in texels side by
/// side.
bool Joiner::isSmooth(uint32_t h) const {
    return !isCrease(h) && !edging_[h / 3] && !edging_[mesh_.opposite[h] / 3];
}

std::optional<Candidate> Joiner::candidateOf(size_t first, size_t last) const {
    const uint32_t a = seams_[first].a, b = seams_[first].b;
    if (isRefused(a, b)) return std::nullopt;
    double length = 0.0, smooth = 0.0, crease = 0.0;
    for (size_t i = first; i < last; ++i) {
        const uint32_t h = seams_[i].halfEdge;
        const double one = lengthOf(h);
        length += one;
        if (isSmooth(h)) smooth += one;
        if (isCrease(h)) crease += one;
    }
    const FlatChart &left = set_.charts[a], &right = set_.charts[b];
    const auto isNarrow = [&](const FlatChart& chart) { return chart.width() < kNarrow * texel_; };
    const bool narrow = isNarrow(left) || isNarrow(right);
    if (!narrow && smooth < 0.5 * length) return std::nullopt;
    // Light may be another one across it: a wide chart's last texels would have that of the narrow one.
    if (crease > 0.5 * length && !(isNarrow(left) && isNarrow(right))) return std::nullopt;
    const double score = length / std::min(left.border, right.border);
    if (!(score > kLeastShared)) return std::nullopt;
    return Candidate{a, b, first, last, score, narrow};
}

std::vector<Candidate> Joiner::candidates() {
    findSeams();
    std::vector<Candidate> all;
    for (size_t first = 0; first < seams_.size();) {
        size_t last = first;
        while (last < seams_.size() && seams_[last].a == seams_[first].a && seams_[last].b == seams_[first].b)
            ++last;
        if (const auto candidate = candidateOf(first, last)) all.push_back(*candidate);
        first = last;
    }
    return all;
}

/// Chooses pairs without a chart in common, the best first.
std::vector<Candidate> Joiner::choose(const std::vector<Candidate>& all) const {
    std::vector<uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t l, uint32_t r) { return all[l].score > all[r].score; });
    std::vector<uint8_t> taken(set_.charts.size());
    std::vector<Candidate> chosen;
    for (uint32_t i : order) {
        if (taken[all[i].a] || taken[all[i].b]) continue;
        taken[all[i].a] = taken[all[i].b] = 1;
        chosen.push_back(all[i]);
    }
    return chosen;
}

/// Returns the half-edges of the longest stretch of seam that hangs together, on the side of the chart that
/// stays.
std::vector<uint32_t> Joiner::longestRun(const Candidate& candidate, bool swapped) const {
    const size_t count = candidate.last - candidate.first;
    std::vector<uint32_t> edges(count), parent(count);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t h = seams_[candidate.first + i].halfEdge;
        edges[i] = swapped ? mesh_.opposite[h] : h;
    }
    std::iota(parent.begin(), parent.end(), 0u);
    const auto find = [&](uint32_t i) {
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    };
    std::vector<std::pair<uint32_t, uint32_t>> ends; // vertex, edge
    for (uint32_t i = 0; i < count; ++i) {
        ends.emplace_back(mesh_.vertex[edges[i]], i);
        ends.emplace_back(mesh_.vertex[WeldedMesh::nextCorner(edges[i])], i);
    }
    std::sort(ends.begin(), ends.end());
    for (size_t i = 1; i < ends.size(); ++i) {
        if (ends[i].first != ends[i - 1].first) continue;
        const uint32_t l = find(ends[i - 1].second), r = find(ends[i].second);
        parent[std::max(l, r)] = std::min(l, r);
    }
    std::vector<double> length(count);
    for (uint32_t i = 0; i < count; ++i)
        length[find(i)] += lengthOf(edges[i]);
    const size_t best = static_cast<size_t>(std::max_element(length.begin(), length.end()) - length.begin());
    std::vector<uint32_t> run;
    for (uint32_t i = 0; i < count; ++i)
        if (find(i) == best) run.push_back(edges[i]);
    return run;
}

Match Joiner::matchOf(uint32_t h, bool atEnd) const {
    const uint32_t other = mesh_.opposite[h];
    return {set_.uv[atEnd ? WeldedMesh::nextCorner(h) : h],
            set_.uv[atEnd ? other : WeldedMesh::nextCorner(other)], lengthOf(h)};
}

/// Returns how far the ends of an edge are from where they should be.
double Joiner::mismatch(uint32_t h, const Motion& motion) const {
    double most = 0.0;
    for (bool atEnd : {false, true}) {
        const Match match = matchOf(h, atEnd);
        most = std::max(most, glm::distance(match.here, motion(match.there)));
    }
    return most;
}

bool Joiner::mayRelax(const FlatChart& large, const FlatChart& small) const {
    if (large.triangles.size() + small.triangles.size() > kMostRelaxed) return false;
    if (large.plane && !(large.stretch.surface < kSmallPart * small.stretch.surface)) return false;
    return !small.plane || small.stretch.surface < kSmallPart * large.stretch.surface;
}

std::optional<Joined> Joiner::glue(const FlatChart& large, const FlatChart& small, std::vector<uint32_t> seam,
                                   const Motion& motion, bool relax) {
    std::vector<uint32_t> triangles = large.triangles;
    triangles.insert(triangles.end(), small.triangles.begin(), small.triangles.end());
    for (uint32_t h : seam)
        set_.glued[h] = set_.glued[mesh_.opposite[h]] = 1;
    const ChartPatch patch = makePatch(mesh_, std::move(triangles), set_.glued, slot_);
    for (uint32_t h : seam)
        set_.glued[h] = set_.glued[mesh_.opposite[h]] = 0;
    // A vertex on the seam stays where the larger chart has it; to relax, it begins in the middle.
    std::vector<glm::dvec2> positions(patch.vertices, glm::dvec2(0.0));
    std::vector<uint32_t> times(patch.vertices);
    const size_t second = 3 * large.triangles.size();
    for (size_t i = 0; i < patch.vertex.size(); ++i) {
        const uint32_t v = patch.vertex[i];
        if (!relax && times[v] > 0) continue;
        const glm::dvec2& own = set_.uv[3 * size_t(patch.triangles[i / 3]) + i % 3];
        positions[v] += i < second ? own : motion(own);
        ++times[v];
    }
    if (relax) {
        for (uint32_t v = 0; v < patch.vertices; ++v)
            positions[v] /= double(times[v]);
        if (!relaxPatch(mesh_, patch, positions)) return std::nullopt;
    }
    Joined joined;
    joined.uv.resize(patch.vertex.size());
    for (size_t i = 0; i < joined.uv.size(); ++i)
        joined.uv[i] = positions[patch.vertex[i]];
    Stretch stretch;
    for (size_t i = 0; i < patch.triangles.size(); ++i)
        stretch.add(&mesh_.corners[3 * size_t(patch.triangles[i])], &joined.uv[3 * i]);
    if (!(stretch.normalised() <= kMostStretch)) return std::nullopt;
    if (chartOverlaps(joined.uv, relax ? 0 : large.triangles.size())) return std::nullopt;
    joined.chart.plane = !relax && large.plane;
    const double scale = relax ? std::sqrt(stretch.surface / stretch.flat) : 1.0;
    for (glm::dvec2& p : joined.uv)
        p *= scale;
    stretch.flat *= scale * scale;
    stretch.squares /= scale * scale;
    joined.chart.stretch = stretch;
    joined.chart.triangles = patch.triangles;
    joined.chart.border = large.border + small.border;
    for (uint32_t h : seam)
        joined.chart.border -= 2.0 * lengthOf(h);
    joined.glued = std::move(seam);
    return joined;
}

/// Fits two charts along a part of their seam. Where that has one shape in both, all other seams that then
/// fit are added.
Joiner::Fit Joiner::fit(const Candidate& candidate, bool swapped, std::vector<uint32_t> run) const {
    Fit fit{std::move(run), {}, 0.0, 0.0};
    std::vector<Match> matches;
    for (uint32_t h : fit.run) {
        matches.push_back(matchOf(h, false));
        matches.push_back(matchOf(h, true));
        fit.length += lengthOf(h);
    }
    fit.motion = fitMotion(matches);
    for (uint32_t h : fit.run)
        fit.mismatch = std::max(fit.mismatch, mismatch(h, fit.motion));
    if (!fit.isRigid()) return fit;
    for (size_t i = candidate.first; i < candidate.last; ++i) {
        const uint32_t h = swapped ? mesh_.opposite[seams_[i].halfEdge] : seams_[i].halfEdge;
        if (std::find(fit.run.begin(), fit.run.end(), h) != fit.run.end()) continue;
        if (mismatch(h, fit.motion) > kSameShape * lengthOf(h)) continue;
        fit.run.push_back(h);
        fit.length += lengthOf(h);
    }
    return fit;
}

std::optional<Joined> Joiner::attempt(const Candidate& candidate) {
    const bool swapped = set_.charts[candidate.a].stretch.surface < set_.charts[candidate.b].stretch.surface;
    const FlatChart& large = set_.charts[swapped ? candidate.b : candidate.a];
    const FlatChart& small = set_.charts[swapped ? candidate.a : candidate.b];
    const double least = kLeastShared * std::min(large.border, small.border);
    std::vector<uint32_t> run = longestRun(candidate, swapped);
    Fit whole = fit(candidate, swapped, run);
    if (!(whole.length > least)) return std::nullopt;
    if (whole.isRigid()) return glue(large, small, std::move(whole.run), whole.motion, false);
    if (whole.mismatch <= kLikeShape * whole.length && mayRelax(large, small))
        return glue(large, small, std::move(whole.run), whole.motion, true);
    if (!large.plane || !small.plane) return std::nullopt;
    // Planes whose seam bends unlike in both are unfolded along one of its edges, as along a hinge.
    std::stable_sort(run.begin(), run.end(),
                     [&](uint32_t l, uint32_t r) { return lengthOf(l) > lengthOf(r); });
    for (size_t i = 0; i < std::min(run.size(), kMostHinges); ++i) {
        Fit hinge = fit(candidate, swapped, {run[i]});
        if (!hinge.isRigid() || !(hinge.length > least)) continue;
        if (auto joined = glue(large, small, std::move(hinge.run), hinge.motion, false)) return joined;
    }
    return std::nullopt;
}

void Joiner::apply(const Candidate& candidate, Joined& joined) {
    for (size_t i = 0; i < joined.uv.size(); ++i)
        set_.uv[3 * size_t(joined.chart.triangles[i / 3]) + i % 3] = joined.uv[i];
    for (uint32_t h : joined.glued)
        set_.glued[h] = set_.glued[mesh_.opposite[h]] = 1;
    if (candidate.narrow) {
        const FlatChart &a = set_.charts[candidate.a], &b = set_.charts[candidate.b];
        for (uint32_t t : (a.stretch.surface < b.stretch.surface ? a : b).triangles)
            edging_[t] = 1;
    }
    for (uint32_t t : joined.chart.triangles)
        chartOf_[t] = candidate.a;
    set_.charts[candidate.a] = std::move(joined.chart);
    set_.charts[candidate.b] = {};
    ++version_[candidate.a];
    ++version_[candidate.b];
}

void Joiner::run() {
    for (uint32_t round = 0; round < kMostRounds; ++round) {
        const std::vector<Candidate> chosen = choose(candidates());
        if (chosen.empty()) return;
        std::vector<std::optional<Joined>> results(chosen.size());
        pool_.run(static_cast<uint32_t>(chosen.size()), [&](uint32_t i) { results[i] = attempt(chosen[i]); });
        for (size_t i = 0; i < chosen.size(); ++i) {
            const Candidate& c = chosen[i];
            if (results[i])
                apply(c, *results[i]);
            else
                refused_.push_back({c.a, c.b, version_[c.a], version_[c.b]});
        }
        std::erase_if(refused_, [&](const Refused& r) {
            return version_[r.a] != r.versionA || version_[r.b] != r.versionB;
        });
        std::sort(refused_.begin(), refused_.end(),
                  [](const Refused& l, const Refused& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; });
    }
}

} // namespace

void joinCharts(const WeldedMesh& mesh, double texel, WorkerPool& pool, ChartSet& set) {
    Joiner(mesh, texel, pool, set).run();
}

} // namespace relume
