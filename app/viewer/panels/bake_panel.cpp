#include "app/viewer/panels/bake_panel.h"

#include "app/offline/bake_options.h"
#include "app/viewer/panels/widgets.h"
#include "bake/trace/make_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <imgui.h>

namespace relume {
namespace {

constexpr std::array<Method, 7> kOfferedMethods = {Method::Hybrid,  Method::Directional, Method::Pure,
                                                   Method::Static,  Method::MonteCarlo,  Method::Mipmapped,
                                                   Method::Adaptive};
constexpr std::array<uint32_t, 10> kSizes = {32, 64, 128, 256, 384, 512, 768, 1024, 1536, 2048};
constexpr std::array<uint32_t, 6> kWindows = {1, 2, 4, 8, 16, 32};
constexpr std::array<uint32_t, 6> kNodes = {2, 4, 8, 16, 32, 64};
constexpr std::array<uint32_t, 3> kScales = {1, 2, 4};
constexpr std::array<uint32_t, 4> kVoxels = {32, 64, 128, 256};
constexpr uint32_t kMostSamples = 65536, kMostRatio = 256;

// Tells whether a slider or field in which one drags or types was let go of. Otherwise each step would start
// a bake.
bool released() {
    return ImGui::IsItemDeactivatedAfterEdit();
}

} // namespace

void BakePanel::drawMethod(bool& done) {
    SolverSettings& solver = draft_.bake.solver;
    bool rtrad = solver.transport.rtrad;
    if (ui::checkbox("RTRad preset", &rtrad)) {
        solver.transport.rtrad = rtrad;
        solver.transport.reflectivity = rtrad ? kRtradReflectivity : 1.0f;
        if (!rtrad) solver.transport.distanceFactor = 1.0f;
        if (rtrad && !isPairMethod(solver.method)) solver.method = Method::Pure;
        draft_.lightmap.rtrad = rtrad;
        draft_.lightmap.quantity = rtrad ? Quantity::Radiance : Quantity::Lighting;
        done = true;
    }
    ui::tip("The reference implementation to the letter, with its clamps");
    std::array<const char*, kOfferedMethods.size()> names{};
    std::transform(kOfferedMethods.begin(), kOfferedMethods.end(), names.begin(), methodName);
    auto index = static_cast<size_t>(
        std::find(kOfferedMethods.begin(), kOfferedMethods.end(), solver.method) - kOfferedMethods.begin());
    if (ui::combo("Method", index, names)) {
        solver.method = kOfferedMethods[index];
        // A method has no use for what another one keeps.
        if (solver.cache.kind != CacheSettings::Kind::None) solver.cache.kind = CacheSettings::Kind::Auto;
        if (hasWindow(solver.method) && solver.pairs.window < 2) solver.pairs.window = 2;
        done = true;
    }
    ui::tip("Area: pure and its samplings ask about pairs of patches. Hemispheric: directional and hybrid "
            "follow directions");
    if (isPairMethod(solver.method))
        drawPairs(done);
    else
        drawLinks(done);
    constexpr std::array kLinkCaches = {"automatic", "none", "links"};
    constexpr std::array kPairCaches = {"automatic", "none", "bits"};
    const bool pairs = isPairMethod(solver.method);
    size_t cache = std::min(static_cast<size_t>(solver.cache.kind), size_t{2});
    if (ui::combo("Cache", cache, pairs ? kPairCaches : kLinkCaches)) {
        constexpr std::array kKinds = {CacheSettings::Kind::Auto, CacheSettings::Kind::None};
        solver.cache.kind = cache < 2 ? kKinds[cache]
                            : pairs   ? CacheSettings::Kind::Bits
                                      : CacheSettings::Kind::Links;
        done = true;
    }
    ui::tip("Keeps for later passes what rays found");
    double mebibytes = static_cast<double>(solver.cache.bytes) / ui::kMebi;
    if (ui::number("Cache memory [MiB]", mebibytes, "%.0f")) {
        constexpr double kMost = 1e7;
        solver.cache.bytes = static_cast<uint64_t>(std::clamp(mebibytes, 0.0, kMost) * ui::kMebi);
        done = true;
    }
    ui::tip("0: a third of the free device memory; for links a quarter of the machine's, too");
}

void BakePanel::drawPairs(bool& done) {
    PairSettings& pairs = draft_.bake.solver.pairs;
    if (hasWindow(draft_.bake.solver.method)) {
        done |= ui::combo("Window [texels]", pairs.window, kWindows);
        ui::tip("One sender stands for so many by so many texels");
    }
    if (draft_.bake.solver.method != Method::Adaptive) return;
    auto threshold = static_cast<float>(pairs.threshold);
    constexpr float kLeast = 0.001f, kMost = 0.5f;
    if (ui::sliderFloat("Threshold", &threshold, kLeast, kMost, "%.3f", ImGuiSliderFlags_Logarithmic))
        pairs.threshold = threshold;
    done |= released();
    ui::tip("Difference up to which nodes are merged, relative to the mean light");
    auto ramp = static_cast<float>(pairs.thresholdRamp);
    if (ui::sliderFloat("Threshold ramp", &ramp, 0.1f, 4.0f, "%.2f", ImGuiSliderFlags_Logarithmic))
        pairs.thresholdRamp = ramp;
    done |= released();
    ui::tip("Factor on the threshold from pass to pass");
    done |= ui::combo("Largest node [texels]", pairs.node, kNodes);
}

void BakePanel::drawLinks(bool& done) {
    LinkSettings& links = draft_.bake.solver.links;
    done |= ui::number("Samples", links.samples);
    links.samples = std::min(links.samples, kMostSamples);
    ui::tip("Directions per patch; 0: as many as the error needs");
    constexpr std::array kSets = {"Sobol", "largest empty circle"};
    auto set = static_cast<size_t>(links.directions);
    if (ui::combo("Directions", set, kSets)) {
        links.directions = static_cast<DirectionSet>(set);
        done = true;
    }
    constexpr std::array kRotations = {Rotation::Patch, Rotation::Interleaved, Rotation::Tile};
    constexpr std::array kNames = {"per patch", "interleaved 4 x 4", "per tile"};
    auto rotation = static_cast<size_t>(std::find(kRotations.begin(), kRotations.end(), links.rotation) -
                                        kRotations.begin());
    if (ui::combo("Rotation", rotation, kNames)) {
        links.rotation = kRotations[rotation];
        done = true;
    }
    done |= ui::combo("Indirect scale", links.indirectScale, kScales);
    ui::tip("Follow directions from one patch of so many by so many texels and interpolate");
    {
        const ui::Disabled disabled(draft_.bake.solver.method != Method::Hybrid);
        done |= ui::checkbox("Smooth", &links.smooth);
    }
    ui::tip("Hybrid: smooth the indirect light");
    ImGui::SameLine();
    done |= ui::checkbox("Footprint", &links.footprint);
    ui::tip("Read the mean light over what each direction stands for: less noise, but biased");
}

void BakePanel::drawTracer(bool& done) {
    BakeSettings& bake = draft_.bake;
    constexpr std::array kNames = {"automatic", "rtp", "query", "bvh", "embree", "voxel"};
    auto kind = static_cast<size_t>(bake.tracer);
    if (ui::combo("Tracer", kind, kNames)) {
        bake.tracer = static_cast<TracerKind>(kind);
        if (bake.tracer == TracerKind::Voxel)
            bake.voxels.ratio = 1;
        else if (bake.voxels.ratio == 1)
            bake.voxels.ratio = 0;
        done = true;
    }
    const bool voxels = bake.tracer == TracerKind::Voxel;
    {
        const ui::Disabled disabled(voxels);
        int ratio = static_cast<int>(bake.voxels.ratio);
        if (ui::sliderInt("Voxel ratio", &ratio, 0, kMostRatio))
            bake.voxels.ratio = static_cast<uint32_t>(std::clamp(ratio, 0, static_cast<int>(kMostRatio)));
        done |= released();
        ui::tip("One sender in this many marches through voxels; 0: none, 1: all");
    }
    const ui::Disabled disabled(!voxels && bake.voxels.ratio == 0);
    done |= ui::combo("Voxels along an edge", bake.voxels.resolution, kVoxels);
    done |= ui::checkbox("Gather by shaders", &bake.solver.transport.deviceGather);
    ui::tip("Also where the device is the CPU, whose own loops are faster");
}

void BakePanel::drawTransport(bool& done) {
    TransportSettings& transport = draft_.bake.solver.transport;
    ui::sliderFloat("Reflectivity", &transport.reflectivity, 0.0f, 10.0f, "%.2f",
                    ImGuiSliderFlags_AlwaysClamp);
    done |= released();
    if (ImGui::IsItemDeactivated()) draft_.lightmap.reflectivity = transport.reflectivity;
    ui::tip("Scales the albedo");
    const ui::Disabled disabled(!transport.rtrad);
    ui::sliderFloat("Distance factor", &transport.distanceFactor, 0.0f, 2.0f, "%.2f",
                    ImGuiSliderFlags_AlwaysClamp);
    done |= released();
    ui::tip("RTRad preset only: it has no physical meaning");
}

void BakePanel::drawLightmap(bool& done) {
    done |= ui::combo("Size [texels]", draft_.bake.size, kSizes);
    done |= ui::number("Another size", draft_.bake.size);
    done |= ui::checkbox("Conservative", &draft_.bake.conservative);
    ui::tip("Every texel that a triangle touches becomes a patch");
    ImGui::SameLine();
    done |= ui::checkbox("Sew seams", &draft_.lightmap.sew);
    ui::tip("Fill the texels around charts");
    const ui::Disabled disabled(!draft_.lightmap.sew);
    int rings = static_cast<int>(draft_.lightmap.dilate);
    constexpr int kMostRings = 64;
    if (ui::sliderInt("Rings of texels filled", &rings, 0, kMostRings))
        draft_.lightmap.dilate = static_cast<uint32_t>(std::clamp(rings, 0, kMostRings));
    done |= released();
}

void BakePanel::drawStop(bool& done) {
    SolverSettings& solver = draft_.bake.solver;
    done |= ui::number("Passes", solver.passes);
    solver.passes = std::min(solver.passes, Solver::kMaxPasses);
    ui::tip("Bounces; 0: as many as the error needs");
    done |= ui::number("Error", solver.error, "%.4g");
    solver.error = std::clamp(solver.error, 0.0, 1.0);
    ui::tip("Stop when the remaining error is below this; 0: by passes and samples alone");
    if (isPairMethod(solver.method)) return;
    done |= ui::number("Local error", solver.localError, "%.4g");
    solver.localError = std::clamp(solver.localError, 0.0, 100.0);
    ui::tip(
        "And when 95 % of all texels are off by less than this, relative to their own light; 0: they may be "
        "off by any");
}

// Applies the draft unless it contradicts itself.
void BakePanel::settle(const PanelContext& context, bool done) {
    active_ = ImGui::IsAnyItemActive();
    if (!done) return;
    const std::optional<Document> next = draft_.settle(context.session.document());
    if (!next) return;
    context.edit("Bake settings", *next);
    context.endEdit();
}

void BakePanel::draw(const PanelContext& context) {
    // A change made elsewhere (undo) is taken over, unless something is being typed or was until now: a field
    // tells only one frame later that it was left.
    draft_.follow(context.session.document(), context.session.firstBake(),
                  active_ || ImGui::IsAnyItemActive());
    drawBakeProgress(context);
    bool done = false;
    ImGui::PushItemWidth(ImGui::GetFontSize() * -11.0f);
    if (draft_.waits()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.6f, 0.3f, 1.0f));
        ImGui::TextWrapped("Not applied: %s", draft_.problem().c_str());
        ImGui::PopStyleColor();
        if (ui::button("Back to what is baked")) draft_.drop();
    }
    if (ui::header("Gathering", ImGuiTreeNodeFlags_DefaultOpen)) drawMethod(done);
    if (ui::header("Lightmap", ImGuiTreeNodeFlags_DefaultOpen)) drawLightmap(done);
    if (ui::header("When to stop", ImGuiTreeNodeFlags_DefaultOpen)) drawStop(done);
    if (ui::header("Light transport")) drawTransport(done);
    if (ui::header("Rays")) drawTracer(done);
    if (ui::header("Work")) {
        auto budget = static_cast<float>(context.budgetMs);
        constexpr float kLeast = 1, kMost = 45; // [ms], a submit stays below 50
        if (ui::sliderFloat("Batch [ms]", &budget, kLeast, kMost, "%.0f"))
            context.budgetMs = std::clamp(budget, kLeast, kMost);
        ui::tip("Aim of one batch while the camera is still; a quarter of it while it moves. Batches change "
                "no byte of the result");
    }
    ImGui::PopItemWidth();
    settle(context, done);
}

} // namespace relume
