#include "app/offline/layer_join.h"

#include "app/offline/name_lines.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "bake/layers/composite.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>

#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

constexpr const char* kError = "relume:error";
constexpr const char* kPasses = "relume:passes"; // bounces of all layers together

std::string attributeOf(const FloatImage& image, const char* name) {
    const auto found = image.attributes.find(name);
    return found == image.attributes.end() ? "" : found->second;
}

// Returns the first word of `text` that `other` has not; "": it has all of them.
std::string differingWord(const std::string& text, const std::string& other) {
    const std::string all = " " + other + " ";
    std::istringstream words(text);
    for (std::string word; words >> word;)
        if (all.find(" " + word + " ") == std::string::npos) return word;
    return "";
}

// Returns the numbers as text that makes the same numbers again.
std::string estimateOf(const Layer& layer) {
    std::string text = fmt::format("{} {} {} {} {}", layer.light, layer.directVariance,
                                   layer.indirectVariance, layer.error, layer.iterationError);
    for (const glm::vec3& entry : layer.sketch.entries)
        text += fmt::format(" {} {} {}", entry.r, entry.g, entry.b);
    return text;
}

// One layer on its way into the joined image.
struct JobLayer {
    LayeredImage::Layer layer;
    size_t place = 0;                // in the order of the scene's lights
    std::unique_ptr<Layer> estimate; // as much as compositeOf() asks for; nullptr: it is off
    std::string path;                // of its file
};

// Reads what the layer tells of its error. Throws Error, naming the file, where it does not.
std::unique_ptr<Layer> estimateIn(const LayeredImage::Layer& part, const std::string& path) {
    const auto found = part.attributes.find(job_attribute::kEstimate);
    const auto fail = [&] {
        throw Error(fmt::format("{}: layer {} does not tell its error: bake it again with --lights", path,
                                inQuotes(part.name)));
    };
    if (found == part.attributes.end()) fail();
    std::vector<double> numbers;
    std::istringstream words(found->second);
    for (std::string word; words >> word;) {
        const std::optional<double> number = finiteNumber(word);
        if (!number) fail();
        numbers.push_back(*number);
    }
    constexpr size_t kScalars = 5, kChannels = 3;
    const bool sketched = numbers.size() == kScalars + size_t{kSketchEntries} * kChannels;
    if (numbers.size() != kScalars && !sketched) fail();
    auto layer = std::make_unique<Layer>();
    layer->source.weight = part.weight;
    layer->light = numbers[0];
    layer->directVariance = numbers[1];
    layer->indirectVariance = numbers[2];
    layer->error = numbers[3];
    layer->iterationError = numbers[4];
    for (size_t i = kScalars; i < numbers.size(); i += kChannels)
        layer->sketch.entries.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return layer;
}

// Returns the error of the weighted sum of all layers that shine, as LayerSchedule::told() has it.
double errorOf(const std::vector<JobLayer>& layers) {
    std::vector<Layer*> shining;
    for (const JobLayer& layer : layers)
        if (layer.estimate) shining.push_back(layer.estimate.get());
    return compositeOf(shining).error;
}

[[noreturn]] void failToJoin(const LayerFile& file, const LayerFile& first, const std::string& why) {
    throw Error(fmt::format("{}: cannot be joined with {}: {}", file.path, first.path, why));
}

void requireAlike(const LayerFile& file, const LayerFile& first) {
    const FloatImage &own = file.image.composite, &other = first.image.composite;
    if (own.width != other.width || own.height != other.height)
        failToJoin(file, first,
                   fmt::format("it has {} x {} texels, not {} x {}: bake both with the same --size",
                               own.width, own.height, other.width, other.height));
    const auto alike = [&](const char* name) { return attributeOf(own, name) == attributeOf(other, name); };
    if (!alike("relume:version"))
        failToJoin(file, first,
                   fmt::format("it was baked by version {}, not {}: bake both by one program",
                               attributeOf(own, "relume:version"), attributeOf(other, "relume:version")));
    if (!alike("relume:scene"))
        failToJoin(file, first,
                   fmt::format("it is of {}, not of {}: bake both of one scene",
                               inQuotes(attributeOf(own, "relume:scene")),
                               inQuotes(attributeOf(other, "relume:scene"))));
    if (!alike("relume:settings"))
        failToJoin(
            file, first,
            fmt::format(
                "it was baked with other options ({}, not {}): bake both with the same ones",
                differingWord(attributeOf(own, "relume:settings"), attributeOf(other, "relume:settings")),
                differingWord(attributeOf(other, "relume:settings"), attributeOf(own, "relume:settings"))));
    const std::vector<float>*ownCoverage = own.find("coverage"), *otherCoverage = other.find("coverage");
    const bool covered =
        ownCoverage && otherCoverage ? *ownCoverage == *otherCoverage : ownCoverage == otherCoverage;
    if (!alike(job_attribute::kLights) || !alike(job_attribute::kScene) || !covered)
        failToJoin(
            file, first,
            "the scene was another one, or made into patches by another kind of device: bake both anew");
}

// Adds the file's layers to those of other files.
void takeLayers(LayerFile& file, const std::vector<std::string>& lights, std::vector<JobLayer>& to) {
    for (LayeredImage::Layer& layer : file.image.layers) {
        const auto same = std::find_if(to.begin(), to.end(),
                                       [&](const JobLayer& other) { return other.layer.name == layer.name; });
        if (same != to.end())
            throw Error(fmt::format("{}: has layer {}, which {} has, too: leave one of the two files out",
                                    file.path, inQuotes(layer.name), same->path));
        const auto light = std::find(lights.begin(), lights.end(), layer.name);
        if (light == lights.end())
            throw Error(fmt::format("{}: layer {} is of none of the lights that it names: bake with --lights",
                                    file.path, inQuotes(layer.name)));
        const bool shines = layer.weight != glm::vec3(0.0f);
        std::unique_ptr<Layer> estimate = shines ? estimateIn(layer, file.path) : nullptr;
        to.push_back(
            {std::move(layer), static_cast<size_t>(light - lights.begin()), std::move(estimate), file.path});
    }
}

uint64_t passesOf(const LayerFile& file) {
    const std::optional<uint64_t> passes = wholeNumber(attributeOf(file.image.composite, kPasses));
    if (!passes) throw Error(file.path + ": does not tell its number of passes: bake it again");
    return *passes;
}

} // namespace

void noteJob(LayeredImage& image, const LayerSolver& solver, const JobScene& scene) {
    ASSERT(image.layers.size() == solver.layers().size());
    if (image.layers.size() == scene.lights.size()) return;
    image.composite.attributes[job_attribute::kLights] = linesOf(scene.lights);
    image.composite.attributes[job_attribute::kScene] = fmt::format("{:016x}", scene.fingerprint);
    for (size_t i = 0; i < image.layers.size(); ++i)
        if (solver.layers()[i]->has())
            image.layers[i].attributes[job_attribute::kEstimate] = estimateOf(*solver.layers()[i]);
}

LayeredImage joinLayers(std::vector<LayerFile> files) {
    ASSERT(!files.empty());
    if (files.size() == 1) return std::move(files.front().image);
    const std::vector<std::string> lights =
        namesIn(attributeOf(files.front().image.composite, job_attribute::kLights));
    for (const LayerFile& file : files)
        if (attributeOf(file.image.composite, job_attribute::kLights).empty())
            throw Error(file.path +
                        ": has all lights of its scene, or was not baked with --lights: leave it out");
    std::vector<JobLayer> layers;
    uint64_t passes = 0;
    for (LayerFile& file : files) {
        requireAlike(file, files.front());
        passes += passesOf(file);
        takeLayers(file, lights, layers);
    }
    std::sort(layers.begin(), layers.end(),
              [](const JobLayer& a, const JobLayer& b) { return a.place < b.place; });
    LayeredImage joined{std::move(files.front().image.composite), {}};
    std::map<std::string, std::string>& attributes = joined.composite.attributes;
    attributes[kPasses] = std::to_string(passes);
    attributes[kError] = fmt::format("{:.6g}", errorOf(layers));
    const bool whole = layers.size() == lights.size();
    if (whole) {
        attributes.erase(job_attribute::kLights);
        attributes.erase(job_attribute::kScene);
    }
    for (JobLayer& layer : layers) {
        if (whole) layer.layer.attributes.erase(job_attribute::kEstimate);
        joined.layers.push_back(std::move(layer.layer));
    }
    return joined;
}

std::vector<std::string> missingLights(const LayeredImage& image) {
    std::vector<std::string> missing = namesIn(attributeOf(image.composite, job_attribute::kLights));
    std::erase_if(missing, [&](const std::string& name) {
        return std::any_of(image.layers.begin(), image.layers.end(),
                           [&](const LayeredImage::Layer& layer) { return layer.name == name; });
    });
    return missing;
}

} // namespace relume
