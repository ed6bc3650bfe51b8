#include "bake/surface/cit_pass.h"

#include "assets/base/log.h"
#include "assets/base/portions.h"
#include "assets/base/warnings.h"
#include "assets/images/box_filter.h"
#include "bake/base/shader_types.h"
#include "bake/surface/masked_texels.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <utility>

namespace relume {
namespace {

// Images on the device, one per (image, colour space), and the texture array that the materials point into.
class TextureArray {
public:
    TextureArray(const vk::Device& device, const Scene& scene) : device_(device), scene_(scene) {}

    // Adds a texture and returns its index into bound(), -1 for none.
    int add(const TextureRef& ref, bool srgb) {
        if (ref.texture < 0) return -1;
        const auto [it, isNew] = indices_.try_emplace({ref.texture, srgb}, static_cast<int>(bound_.size()));
        if (!isNew) return it->second;
        const Texture& texture = scene_.textures[static_cast<size_t>(ref.texture)];
        const VkFilter filter = texture.nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
        samplers_.emplace_back(device_, filter, mode(texture.wrapS), mode(texture.wrapT), kAnisotropy);
        bound_.push_back({image(texture.image, srgb), samplers_.back().handle()});
        return it->second;
    }
    // Returns the texture array, which is never empty, so that it can be bound.
    const std::vector<vk::RasterProgram::BoundTexture>& bound() {
        if (bound_.empty()) {
            const uint32_t white = 0xffffffffu;
            images_.push_back(upload(1, 1, VK_FORMAT_R8G8B8A8_UNORM, &white));
            samplers_.emplace_back(device_, VK_FILTER_NEAREST, VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                   VK_SAMPLER_ADDRESS_MODE_REPEAT, 1.0f);
            bound_.push_back({images_.back().view(), samplers_.back().handle()});
        }
        return bound_;
    }

    uint64_t bytes() const { return bytes_; }
    const Warnings& warnings() const { return warnings_; }

private:
    // A texel of the lightmap often covers a long thin strip of a texture.
    static constexpr float kAnisotropy = 16.0f;

    static VkSamplerAddressMode mode(Wrap wrap) {
        if (wrap == Wrap::ClampToEdge) return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        return wrap == Wrap::Repeat ? VK_SAMPLER_ADDRESS_MODE_REPEAT
                                    : VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    }
    vk::Image2D upload(uint32_t width, uint32_t height, VkFormat format, const void* pixels) {
        const auto mips = static_cast<uint32_t>(std::bit_width(std::max(width, height)));
        vk::Image2D result(device_, {.width = width,
                                     .height = height,
                                     .mips = mips,
                                     .format = format,
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                              VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                     .name = "texture"});
        vk::uploadPixels(device_, result, pixels, VkDeviceSize{width} * height * 4);
        bytes_ += uint64_t{width} * height * 16 / 3; // 4 each, and smaller mips
        return result;
    }
    VkImageView image(int index, bool srgb) {
        const auto [it, isNew] = imageIndices_.try_emplace({index, srgb}, images_.size());
        if (isNew) {
            const Image& source = scene_.images[static_cast<size_t>(index)];
            const VkFormat format = srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
            const uint32_t most = device_.limits().maxImageDimension2D;
            const bool fits = std::max(source.width, source.height) <= most;
            if (!fits) warnings_.add(imageName(scene_, index), tooLarge(source.width, source.height, most));
            const Image smaller = fits ? Image() : shrunkTo(most, source, srgb);
            const Image& taken = fits ? source : smaller;
            images_.push_back(upload(taken.width, taken.height, format, taken.rgba.data()));
        }
        return images_[it->second].view();
    }

    const vk::Device& device_;
    const Scene& scene_;
    std::map<std::pair<int, bool>, int> indices_;
    std::map<std::pair<int, bool>, size_t> imageIndices_;
    std::vector<vk::Image2D> images_;
    std::vector<vk::Sampler> samplers_;
    std::vector<vk::RasterProgram::BoundTexture> bound_;
    Warnings warnings_;
    uint64_t bytes_ = 0;
};

const std::vector<VkFormat> kFormats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                        VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                        VK_FORMAT_R32_UINT};

// Returns the mesh's materials, ascending; glTF's default one among them needs no texture.
std::vector<uint32_t> materialsOf(const WorldMesh& mesh) {
    std::vector<uint32_t> used = mesh.material;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

std::vector<vk::Image2D> makeTargets(const vk::Device& device, const std::vector<VkFormat>& formats,
                                     VkExtent2D extent) {
    std::vector<vk::Image2D> images;
    for (VkFormat format : formats) {
        images.emplace_back(device, vk::Image2D::Desc{.width = extent.width,
                                                      .height = extent.height,
                                                      .format = format,
                                                      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                                               VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                                      .name = "texture group"});
    }
    return images;
}

// Copies an image in TRANSFER_SRC_OPTIMAL to the host: one row of values per texel row, for which there is
// room. All threads copy: one core alone takes longer than the drawing.
template<typename T>
void readImage(const vk::Buffer& staging, vk::Commands& commands, const vk::Image2D& image,
               const TexelWindow& window, WorkerPool& pool, std::vector<T>& values) {
    ASSERT(window.size() == values.size() && window.size() * sizeof(T) <= staging.size());
    VkCommandBuffer cmd = commands.begin();
    const VkBufferImageCopy region{
        .bufferOffset = 0,
        .bufferRowLength = 0,
        .bufferImageHeight = 0,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageOffset = {static_cast<int32_t>(window.column), static_cast<int32_t>(window.row), 0},
        .imageExtent = {window.columns, window.rows, 1}};
    vkCmdCopyImageToBuffer(cmd, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.handle(), 1,
                           &region);
    vk::hostBarrier(cmd);
    commands.run();
    const T* from = staging.as<T>();
    constexpr size_t kPortion = size_t{1} << 17; // values that a thread copies at a time
    runPortions(pool, values.size(), kPortion,
                [&](size_t begin, size_t end) { std::copy(from + begin, from + end, &values[begin]); });
}

} // namespace

struct CitPass::Impl {
    /// Places in the array of textures, -1: none.
    struct Textures {
        int base = -1, emission = -1, metallic = -1;
    };

    Impl(const vk::Device& on, const Scene& scene, const WorldMesh& mesh)
        : device(on), array(on, scene), materials(materialsOf(mesh)) {
        for (const uint32_t material : materials) {
            const Material m = material < scene.materials.size() ? scene.materials[material] : Material();
            textures.push_back({.base = array.add(m.baseColorTexture, true),
                                .emission = array.add(m.emissionTexture, true),
                                .metallic = array.add(m.metallicRoughnessTexture, false)});
        }
        const auto& bound = array.bound();
        program.emplace(device,
                        vk::RasterProgram::Desc{.vertex = "cit_vert",
                                                .fragment = "cit_frag",
                                                .formats = kFormats,
                                                .textureCount = static_cast<uint32_t>(bound.size()),
                                                .constants = {}},
                        bound);
    }

    // Returns all materials as the shader has them; those that are not used stay as glTF's default one.
    std::vector<shader::CitMaterial> citMaterials(const Scene& scene) const {
        const auto citMaterial = [](const Material& m, const Textures& t) {
            return shader::CitMaterial{.baseColor = glm::vec4(1.0f, 1.0f, 1.0f, m.baseColor.a),
                                       .emission = glm::vec3(1.0f),
                                       .metallic = m.metallic,
                                       .roughness = m.roughness,
                                       .baseTexture = t.base,
                                       .emissionTexture = t.emission,
                                       .metallicTexture = t.metallic};
        };
        std::vector<shader::CitMaterial> all(scene.materials.size() + 1, citMaterial(Material(), Textures()));
        for (size_t i = 0; i < materials.size(); ++i)
            if (materials[i] < scene.materials.size())
                all[materials[i]] = citMaterial(scene.materials[materials[i]], textures[i]);
        return all;
    }

    const vk::Device& device;
    TextureArray array;
    std::vector<uint32_t> materials;
    std::vector<Textures> textures; // one for each of these
    std::optional<vk::RasterProgram> program;
};

CitPass::CitPass(const vk::Device& device, const Scene& scene, const WorldMesh& mesh)
    : impl_(std::make_unique<Impl>(device, scene, mesh)) {}
CitPass::~CitPass() = default;

bool CitPass::serves(const WorldMesh& mesh) const {
    return materialsOf(mesh) == impl_->materials;
}

std::vector<std::string> CitPass::warnings(const Scene& scene) const {
    return impl_->array.warnings().lines(scene.path);
}

uint64_t CitPass::bytes() const {
    return impl_->array.bytes();
}

TextureGroup CitPass::draw(const Scene& scene, const WorldMesh& mesh, const CitDesc& desc) {
    const vk::Device& device = impl_->device;
    const TexelWindow window = desc.window.value_or(TexelWindow{0, 0, desc.size, desc.size});
    ASSERT(window.size() > 0);
    const vk::Buffer materials = vk::makeBuffer(device, impl_->citMaterials(scene), "materials");
    // The window's pixels stay in their places, so that all get what they would in the whole lightmap, to the
    // bit.
    const std::vector<vk::Image2D> images =
        makeTargets(device, kFormats, {window.column + window.columns, window.row + window.rows});
    std::vector<const vk::Image2D*> targets;
    for (const vk::Image2D& image : images)
        targets.push_back(&image);

    const vk::Buffer positions = vk::makeBuffer(device, mesh.positions, "positions");
    const vk::Buffer normals = vk::makeBuffer(device, mesh.normals, "normals");
    const vk::Buffer lightmapUv = vk::makeBuffer(device, mesh.lightmapUv, "lightmap uv");
    const vk::Buffer baseUv = vk::makeBuffer(device, mesh.baseUv, "base colour uv");
    const vk::Buffer emissionUv = vk::makeBuffer(device, mesh.emissionUv, "emission uv");
    const vk::Buffer metallicUv = vk::makeBuffer(device, mesh.metallicUv, "metallic uv");
    const vk::Buffer colors = vk::makeBuffer(device, mesh.colors, "colours");
    const vk::Buffer material = vk::makeBuffer(device, mesh.material, "material of triangle");
    const shader::CitPush push{.positions = positions.address(),
                               .normals = normals.address(),
                               .lightmapUv = lightmapUv.address(),
                               .baseUv = baseUv.address(),
                               .emissionUv = emissionUv.address(),
                               .metallicUv = metallicUv.address(),
                               .colors = colors.address(),
                               .material = material.address(),
                               .materials = materials.address(),
                               .size = desc.size,
                               .grownCount = desc.conservative ? mesh.triangleCount() : 0u,
                               .rtrad = desc.rtrad ? 1u : 0u};
    vk::Commands commands(device);
    impl_->program->draw(commands.begin(), push, targets, 3 * (mesh.triangleCount() + push.grownCount),
                         {.viewport = {desc.size, desc.size},
                          .area = {{static_cast<int32_t>(window.column), static_cast<int32_t>(window.row)},
                                   {window.columns, window.rows}}});
    commands.run();

    TextureGroup group;
    group.size = desc.size;
    group.window = window;
    // One for all: a device takes longer to make such a buffer than to fill it.
    const vk::Buffer staging(device, {.size = window.size() * sizeof(glm::vec4),
                                      .memory = vk::Memory::Host,
                                      .name = "texture group readback"});
    WorkerPool& pool = device.workers();
    const std::array<std::vector<glm::vec4>*, 4> planes{&group.pos, &group.nrm, &group.mat, &group.emission};
    pool.run(static_cast<uint32_t>(planes.size() + 1), [&](uint32_t plane) {
        if (plane < planes.size())
            planes[plane]->resize(window.size());
        else
            group.triangle.resize(window.size());
    });
    for (size_t i = 0; i < planes.size(); ++i)
        readImage(staging, commands, images[i], window, pool, *planes[i]);
    readImage(staging, commands, images[planes.size()], window, pool, group.triangle);
    // RTRad knows no holes.
    if (!desc.rtrad && mesh.opaqueCount < mesh.triangleCount()) findSolidTexels(group, scene, mesh, pool);
    return group;
}

TextureGroup rasterizeTextureGroup(const vk::Device& device, const Scene& scene, const WorldMesh& mesh,
                                   const CitDesc& desc) {
    CitPass pass(device, scene, mesh);
    for (const std::string& warning : pass.warnings(scene))
        spdlog::warn("{}", warning);
    return pass.draw(scene, mesh, desc);
}

} // namespace relume
