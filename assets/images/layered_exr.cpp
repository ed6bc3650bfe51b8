#include "assets/images/layered_exr.h"

#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/warnings.h"
#include "assets/images/exr_check.h"
#include "assets/images/exr_part.h"
#include "assets/images/image_file.h"

#include <ImfIntAttribute.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace relume {
namespace {

constexpr const char* kCompositeName = "composite";
constexpr const char* kLayers = "relume:layers"; // how many there are, in the composite
constexpr const char* kName = "relume:name";     // OpenEXR wants parts' names to differ, lights' may not
constexpr const char* kWeight = "relume:weight";

std::string uniqueName(const std::string& name, std::set<std::string>& taken) {
    const std::string own = name.empty() ? "layer" : name;
    std::string unique = own;
    for (int n = 2; !taken.insert(unique).second; ++n)
        unique = fmt::format("{} {}", own, n);
    return unique;
}

std::vector<Imf::Header> headersOf(const LayeredImage& image, ExrType type, ExrCompression compression) {
    std::set<std::string> taken;
    std::vector<Imf::Header> headers;
    const auto add = [&](const FloatImage& part, const std::string& name) -> Imf::Header& {
        Imf::Header& header = headers.emplace_back(exr::headerOf(part, type, compression));
        header.setName(uniqueName(name, taken));
        header.setType(Imf::SCANLINEIMAGE);
        return header;
    };
    add(image.composite, kCompositeName).insert(kLayers, Imf::IntAttribute(int(image.layers.size())));
    for (const LayeredImage::Layer& layer : image.layers) {
        Imf::Header& header = add(layer.image, layer.name);
        for (const auto& [name, value] : layer.attributes)
            header.insert(name, Imf::StringAttribute(value));
        header.insert(kName, Imf::StringAttribute(layer.name));
        header.insert(kWeight, Imf::V3fAttribute({layer.weight.r, layer.weight.g, layer.weight.b}));
    }
    return headers;
}

std::string encode(const std::string& path, const LayeredImage& image, ExrType type,
                   ExrCompression compression) {
    const std::vector<Imf::Header> headers = headersOf(image, type, compression);
    uint64_t most = exr::mostBytes(image.composite, type);
    for (const LayeredImage::Layer& layer : image.layers)
        most += exr::mostBytes(layer.image, type);
    exr::MemoryOutput stream(path.c_str(), most);
    exr::PartWriter writer(type);
    {
        Imf::MultiPartOutputFile file(stream, headers.data(), int(headers.size()));
        for (size_t p = 0; p < headers.size(); ++p) {
            Imf::OutputPart part(file, int(p));
            writer.write(part, p == 0 ? image.composite : image.layers[p - 1].image);
        }
    } // its destructor writes the tables of lines
    writer.warnAboutCut(path);
    return std::move(stream.bytes);
}

void requireColors(const std::string& path, const FloatImage& image, const std::string& part) {
    for (const char* channel : {"R", "G", "B"})
        if (!image.find(channel))
            throw Error(fmt::format("{}: its part {} has no channel {}: bake it again", path, inQuotes(part),
                                    channel));
}

LayeredImage::Layer readLayer(const std::string& path, Imf::MultiPartInputFile& file, int index) {
    const Imf::Header& header = file.header(index);
    LayeredImage::Layer layer;
    const auto* name = header.findTypedAttribute<Imf::StringAttribute>(kName);
    layer.name = name ? name->value() : header.name();
    const auto* weight = header.findTypedAttribute<Imf::V3fAttribute>(kWeight);
    if (!weight)
        throw Error(fmt::format("{}: its part {} has no attribute {}: bake it again with --layers", path,
                                inQuotes(layer.name), kWeight));
    layer.weight = {weight->value().x, weight->value().y, weight->value().z};
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(layer.weight[c]))
            throw Error(fmt::format("{}: the weight of its part {} is not finite: bake it again", path,
                                    inQuotes(layer.name)));
    Imf::InputPart part(file, index);
    layer.image = exr::readPart(part, path, kMostImagePixels);
    requireColors(path, layer.image, layer.name);
    layer.attributes = std::move(layer.image.attributes);
    layer.attributes.erase(kName);
    layer.image.attributes.clear();
    return layer;
}

/// Checks the parts before pixels are read, which may take long.
void checkParts(const std::string& path, const Imf::MultiPartInputFile& file) {
    const auto* layers = file.header(0).findTypedAttribute<Imf::IntAttribute>(kLayers);
    if (!layers) throw Error(path + ": has no layers: name a file that 'relume bake --layers' wrote");
    if (layers->value() != file.parts() - 1)
        throw Error(fmt::format("{}: has {} of its {} layers: is it complete?", path, file.parts() - 1,
                                layers->value()));
    for (int p = 0; p < file.parts(); ++p) {
        if (!file.partComplete(p))
            throw Error(fmt::format("{}: its part {} is not complete: copy or bake it again", path,
                                    inQuotes(file.header(p).name())));
        const Imath::Box2i window = file.header(p).dataWindow(), first = file.header(0).dataWindow();
        if (window != first)
            throw Error(fmt::format("{}: its part {} has another size than the composite: bake it again",
                                    path, inQuotes(file.header(p).name())));
    }
}

LayeredImage read(const std::string& path, const std::string& bytes) {
    exr::checkHeaders(bytes);
    exr::MemoryInput stream(path.c_str(), bytes);
    Imf::MultiPartInputFile file(stream);
    checkParts(path, file);
    LayeredImage image;
    Imf::InputPart composite(file, 0);
    image.composite = exr::readPart(composite, path, kMostImagePixels);
    requireColors(path, image.composite, kCompositeName);
    std::set<std::string> names;
    for (int p = 1; p < file.parts(); ++p) {
        image.layers.push_back(readLayer(path, file, p));
        if (!names.insert(image.layers.back().name).second)
            throw Error(fmt::format("{}: has two layers named {}: bake it again", path,
                                    inQuotes(image.layers.back().name)));
    }
    return image;
}

std::string oneLine(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

} // namespace

std::string encodeLayeredExr(const std::string& path, const LayeredImage& image, ExrType type,
                             ExrCompression compression) {
    for (const LayeredImage::Layer& layer : image.layers)
        ASSERT(layer.image.width == image.composite.width && layer.image.height == image.composite.height);
    checkWritable(path);
    if (!path.ends_with(".exr")) throw Error(path + ": layers are kept in OpenEXR only: give a name in .exr");
    try {
        return encode(path, image, type, compression);
    } catch (const Error&) { // of who watches
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw Error(path + ": cannot be encoded as OpenEXR: " + oneLine(error.what()));
    }
}

void writeLayeredExr(const std::string& path, const LayeredImage& image, ExrType type,
                     ExrCompression compression) {
    writeFileAtomically(path, encodeLayeredExr(path, image, type, compression));
}

void roundLayers(const std::string& path, LayeredImage& image, ExrType type) {
    if (type == ExrType::Float) return;
    size_t cut = 0;
    WorkerPool pool(0);
    for (LayeredImage::Layer& layer : image.layers)
        for (std::vector<float>& plane : layer.image.planes)
            cut += exr::roundToHalf(pool, plane);
    exr::warnAboutCut(path, cut);
}

LayeredImage readLayeredExr(const std::string& path) {
    const std::string bytes = exr::readBytes(path);
    try {
        return read(path, bytes);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(path + ": does not fit into memory: bake fewer lights or a smaller lightmap");
    } catch (const std::exception& error) {
        throw Error(path + ": cannot be read as layers (" + oneLine(error.what()) + "): is it complete?");
    }
}

} // namespace relume
