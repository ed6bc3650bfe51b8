#include "assets/images/paged_image.h"

#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/numbering.h"
#include "assets/base/portions.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <optional>
#include <utility>

namespace relume {
namespace {

// A sheet says how many pages it has; a page's file says also which one it is, and has a hash of the whole.
constexpr const char* kPages = "relume:pages";
constexpr const char* kPage = "relume:page";
constexpr const char* kWhole = "relume:lightmap";

std::string attributeOf(const FloatImage& image, const char* name) {
    const auto found = image.attributes.find(name);
    return found == image.attributes.end() ? "" : found->second;
}

// Returns the number that an attribute holds, if it is one below or at `most`.
std::optional<uint32_t> numberOf(const FloatImage& image, const char* name, uint32_t most) {
    const std::string text = attributeOf(image, name);
    if (text.empty() || text.size() > 2 || text.find_first_not_of("0123456789") != std::string::npos)
        return std::nullopt;
    const auto number = static_cast<uint32_t>(std::stoul(text));
    return number <= most ? std::optional(number) : std::nullopt;
}

bool exists(const std::string& path) {
    std::error_code code;
    return std::filesystem::exists(path, code);
}

// Portions are hashed by themselves, by all cores, and then their hashes in turn.
uint64_t hashOf(const FloatImage& image, uint64_t hash) {
    constexpr size_t kHashedAtATime = size_t{1} << 18; // texels
    constexpr uint64_t kFactor = 0x9e3779b97f4a7c15u;
    WorkerPool pool(0);
    for (const std::vector<float>& plane : image.planes) {
        std::vector<uint64_t> portions((plane.size() + kHashedAtATime - 1) / kHashedAtATime, 0);
        runPortions(pool, plane.size(), kHashedAtATime, [&](size_t begin, size_t end) {
            uint64_t own = 0;
            for (size_t i = begin; i < end; ++i)
                own = (own ^ std::bit_cast<uint32_t>(plane[i])) * kFactor;
            portions[begin / kHashedAtATime] = own;
        });
        for (const uint64_t portion : portions)
            hash = (hash ^ portion) * kFactor;
    }
    return mixBits(hash ^ image.width);
}

// Returns a text that tells one lightmap's pages from another's.
std::string wholeOf(uint64_t hash) {
    return fmt::format("{:016x}", hash);
}

void notePage(FloatImage& image, uint32_t page, const std::string& whole) {
    image.attributes[kPage] = std::to_string(page);
    image.attributes[kWhole] = whole;
}

// Calls f with the place of the first texel of each of a page's rows, on the sheet and in the page.
template<typename F>
void overRows(uint32_t edge, const LightmapPages& pages, uint32_t page, const F& f) {
    const size_t width = pages.sheetOf(edge);
    const glm::uvec2 cell = pages.cellOf(page);
    for (size_t y = 0; y < edge; ++y)
        f((cell.y * size_t{edge} + y) * width + cell.x * size_t{edge}, y * edge);
}

FloatImage cutOut(const FloatImage& sheet, const LightmapPages& pages, uint32_t page) {
    FloatImage own;
    own.width = own.height = pages.edgeOf(sheet.width);
    own.attributes = sheet.attributes;
    // The planes are got and filled side by side.
    for (const std::string& channel : sheet.channels)
        own.channels.push_back(channel);
    own.planes.resize(sheet.channels.size());
    WorkerPool pool(0);
    pool.run(static_cast<uint32_t>(own.planes.size()), [&](uint32_t c) {
        std::vector<float>& plane = own.planes[c];
        plane.reserve(size_t{own.width} * own.width);
        overRows(own.width, pages, page, [&](size_t there, size_t) {
            const auto row = sheet.planes[c].begin() + static_cast<ptrdiff_t>(there);
            plane.insert(plane.end(), row, row + own.width);
        });
    });
    return own;
}

// Checks what read pages say of themselves against each other and against the name.
void checkPage(const std::string& path, const FloatImage& image, uint32_t page, const std::string& firstPath,
               const FloatImage& first) {
    const auto fail = [&](const std::string& why) { throw Error(path + ": " + why); };
    const std::optional<uint32_t> own = numberOf(image, kPage, kMostPages - 1);
    if (!own)
        fail(fmt::format("is no page of a lightmap, unlike {}: give it another name, or bake again",
                         firstPath));
    if (*own != page)
        fail(fmt::format("is page {} and not {}: was it renamed? Give each page the number that it has", *own,
                         page));
    if (image.width != image.height || image.width != first.width)
        fail(fmt::format("has {} x {} texels and {} has {} x {}: pages are squares of one size: bake again",
                         image.width, image.height, firstPath, first.width, first.height));
    if (image.channels != first.channels)
        fail(fmt::format("has other channels than {}: bake again", firstPath));
    if (attributeOf(image, kWhole) != attributeOf(first, kWhole) ||
        attributeOf(image, kPages) != attributeOf(first, kPages))
        fail(fmt::format("is a page of another lightmap than {}: bake again, or put the pages of one bake "
                         "together",
                         firstPath));
}

// Returns how many pages the first one says that there are.
LightmapPages pagesToRead(const std::string& firstPath, const FloatImage& first) {
    const std::optional<uint32_t> count = numberOf(first, kPages, kMostPages);
    if (count && *count > 1) return {*count};
    throw Error(firstPath + ": does not say how many pages its lightmap has: bake it to .exr");
}

void refuseSinglePage(const std::string& path, const FloatImage& image) {
    const std::string page = attributeOf(image, kPage);
    if (page.empty()) return;
    std::string whole = path;
    const std::string ending = "." + page + std::filesystem::path(path).extension().string();
    if (path.ends_with(ending))
        whole =
            path.substr(0, path.size() - ending.size()) + std::filesystem::path(path).extension().string();
    throw Error(fmt::format("{}: is page {} of a lightmap of {}: name all of them as {}", path, page,
                            attributeOf(image, kPages), whole));
}

// Tells whether a file is a page of a lightmap, and no image that is called so.
bool isPage(const std::string& path) {
    if (!path.ends_with(".exr")) return false;
    try {
        return !attributeOf(readImage(path), kPage).empty();
    } catch (const Error&) {
        return false;
    }
}

// Tells whether a name stands for pages, and throws Error where it stands for an image, too.
bool namesPages(const std::string& path) {
    const std::string first = pagePath(path, 0);
    if (!exists(first)) return false;
    if (exists(path) && !isPage(first)) return false;
    if (exists(path))
        throw Error(
            fmt::format("{}: is there and so are pages of this name ({}): remove what is old", path, first));
    return true;
}

template<typename Read>
std::vector<decltype(std::declval<Read>()(std::string()))> readPages(const std::string& path,
                                                                     const Read& read) {
    const auto imageOf = [](const auto& page) -> const FloatImage& {
        if constexpr (requires { page.composite; })
            return page.composite;
        else
            return page;
    };
    const std::string firstPath = pagePath(path, 0);
    std::vector<decltype(read(path))> all;
    all.push_back(read(firstPath));
    const LightmapPages pages = pagesToRead(firstPath, imageOf(all.front()));
    for (uint32_t page = 0; page < pages.count; ++page) {
        const std::string own = pagePath(path, page);
        if (!exists(own))
            throw Error(
                fmt::format("{}: no such file, but {} says that there are {} pages: copy it there, or "
                            "bake again",
                            own, firstPath, pages.count));
        if (page > 0) all.push_back(read(own));
        checkPage(own, imageOf(all.back()), page, firstPath, imageOf(all.front()));
    }
    return all;
}

void writePages(const std::string& path, const FloatImage& image, ExrType type, ExrCompression compression) {
    const LightmapPages pages = lightmapPagesOf(image);
    if (pages.count == 1) return writeImage(path, image, type, compression);
    const std::string whole = wholeOf(hashOf(image, 0));
    AtomicFiles files;
    for (uint32_t page = 0; page < pages.count; ++page) {
        FloatImage own = cutOut(image, pages, page);
        notePage(own, page, whole);
        const std::string name = pagePath(path, page);
        files.add(name, encodeImage(name, own, type, compression));
    }
    files.commit();
}

} // namespace

void noteLightmapPages(FloatImage& image, const LightmapPages& pages) {
    if (pages.count > 1)
        image.attributes[kPages] = std::to_string(pages.count);
    else
        image.attributes.erase(kPages);
}

LightmapPages lightmapPagesOf(const FloatImage& image) {
    const std::optional<uint32_t> count = numberOf(image, kPages, kMostPages);
    return {count && *count > 0 ? *count : 1};
}

std::string pagePath(const std::string& path, uint32_t page) {
    const std::string ending = std::filesystem::path(path).extension().string();
    return fmt::format("{}.{}{}", path.substr(0, path.size() - ending.size()), page, ending);
}

std::vector<std::string> lightmapFiles(const std::string& path, const LightmapPages& pages) {
    if (pages.count == 1) return {path};
    std::vector<std::string> files;
    for (uint32_t page = 0; page < pages.count; ++page)
        files.push_back(pagePath(path, page));
    return files;
}

FloatImage pageOf(const FloatImage& sheet, uint32_t page) {
    FloatImage own = cutOut(sheet, lightmapPagesOf(sheet), page);
    notePage(own, page, wholeOf(hashOf(sheet, 0)));
    return own;
}

FloatImage sheetOf(const std::vector<FloatImage>& pages, const LightmapPages& layout) {
    ASSERT(pages.size() == layout.count);
    FloatImage sheet;
    sheet.width = sheet.height = layout.sheetOf(pages.front().width);
    sheet.attributes = pages.front().attributes;
    sheet.attributes.erase(kPage);
    sheet.attributes.erase(kWhole);
    noteLightmapPages(sheet, layout);
    for (size_t c = 0; c < pages.front().channels.size(); ++c) {
        std::vector<float>& plane = sheet.add(pages.front().channels[c]);
        for (uint32_t page = 0; page < layout.count; ++page) {
            const FloatImage& own = pages[page];
            overRows(own.width, layout, page, [&](size_t there, size_t here) {
                std::copy_n(own.planes[c].data() + here, own.width, plane.data() + there);
            });
        }
    }
    return sheet;
}

std::string lostInPng(const std::string& path, const FloatImage& image) {
    if (!path.ends_with(".png")) return "";
    constexpr float kCovered = 0.75f; // below it are texels that are filled, or empty
    constexpr double kMany = 0.01;    // fewer are highlights
    const std::vector<float>* coverage = image.find("coverage");
    const std::vector<float>* colors[] = {image.find("R"), image.find("G"), image.find("B")};
    double texels = 0, lost = 0;
    for (size_t i = 0; i < size_t{image.width} * image.height; ++i) {
        if (coverage && (*coverage)[i] < kCovered) continue;
        texels += 1;
        const bool above = std::any_of(std::begin(colors), std::end(colors),
                                       [i](const auto* color) { return color && (*color)[i] > 1.0f; });
        lost += above ? 1 : 0;
    }
    if (lost < kMany * texels || lost == 0) return "";
    return fmt::format("{}: {:.0f} % of its texels are brighter than 1, the most that a .png holds, and were "
                       "cut to it: write an .exr, which holds all",
                       path, 100 * lost / texels);
}

void writeLightmap(const std::string& path, const FloatImage& image, ExrType type,
                   ExrCompression compression) {
    if (const std::string lost = lostInPng(path, image); !lost.empty()) spdlog::warn("{}", lost);
    writePages(path, image, type, compression);
}

void writeLightmapPicture(const std::string& path, const FloatImage& image) {
    writePages(path, image, ExrType::Float, kExrCompression);
}

void writeLayeredLightmap(const std::string& path, const LayeredImage& image, ExrType type,
                          ExrCompression compression) {
    const LightmapPages pages = lightmapPagesOf(image.composite);
    if (pages.count == 1) return writeLayeredExr(path, image, type, compression);
    uint64_t hash = hashOf(image.composite, 0);
    for (const LayeredImage::Layer& layer : image.layers)
        hash = hashOf(layer.image, hash);
    AtomicFiles files;
    for (uint32_t page = 0; page < pages.count; ++page) {
        LayeredImage own{cutOut(image.composite, pages, page), {}};
        notePage(own.composite, page, wholeOf(hash));
        for (const LayeredImage::Layer& layer : image.layers)
            own.layers.push_back(
                {layer.name, layer.weight, layer.attributes, cutOut(layer.image, pages, page)});
        const std::string name = pagePath(path, page);
        files.add(name, encodeLayeredExr(name, own, type, compression));
    }
    files.commit();
}

FloatImage readLightmapFile(const std::string& path, uint64_t mostPixels) {
    if (!namesPages(path)) {
        FloatImage image = readImage(path, mostPixels);
        refuseSinglePage(path, image);
        return image;
    }
    const auto read = [&](const std::string& own) { return readImage(own, mostPixels); };
    const std::vector<FloatImage> pages = readPages(path, read);
    return sheetOf(pages, {static_cast<uint32_t>(pages.size())});
}

FloatImage readImageOrPages(const std::string& path) {
    return namesPages(path) ? readLightmapFile(path) : readImage(path);
}

LayeredImage readLayeredLightmap(const std::string& path) {
    if (!namesPages(path)) {
        LayeredImage image = readLayeredExr(path);
        refuseSinglePage(path, image.composite);
        return image;
    }
    std::vector<LayeredImage> pages =
        readPages(path, [](const std::string& own) { return readLayeredExr(own); });
    const LightmapPages layout{static_cast<uint32_t>(pages.size())};
    // Puts the same image of all pages together.
    const auto gather = [&](const auto& imageOf) {
        std::vector<FloatImage> images;
        for (LayeredImage& page : pages)
            images.push_back(std::move(imageOf(page)));
        return sheetOf(images, layout);
    };
    for (size_t i = 1; i < pages.size(); ++i) {
        const auto same = [](const LayeredImage::Layer& a, const LayeredImage::Layer& b) {
            return a.name == b.name && a.weight == b.weight;
        };
        if (!std::equal(pages[i].layers.begin(), pages[i].layers.end(), pages[0].layers.begin(),
                        pages[0].layers.end(), same))
            throw Error(fmt::format("{}: has other layers than {}: bake again", pagePath(path, uint32_t(i)),
                                    pagePath(path, 0)));
    }
    LayeredImage image;
    for (size_t l = 0; l < pages[0].layers.size(); ++l) {
        LayeredImage::Layer& first = pages[0].layers[l];
        LayeredImage::Layer layer{first.name, first.weight, first.attributes, {}};
        layer.image = gather([&](LayeredImage& page) -> FloatImage& { return page.layers[l].image; });
        layer.image.attributes.clear();
        image.layers.push_back(std::move(layer));
    }
    image.composite = gather([](LayeredImage& page) -> FloatImage& { return page.composite; });
    return image;
}

std::vector<std::string> filesOfLightmap(const std::string& path) {
    const std::string first = pagePath(path, 0);
    if (path.empty() || exists(path) || !exists(first)) return {path};
    std::vector<std::string> files;
    for (uint32_t page = 0; page < kMostPages && exists(pagePath(path, page)); ++page)
        files.push_back(pagePath(path, page));
    return files;
}

} // namespace relume
