#include "app/commands/command.h"
#include "assets/base/log.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/tracer.h"
#include "bake/vk/device.h"

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace relume {

namespace {

constexpr TracerKind kKinds[] = {TracerKind::Rtp, TracerKind::Query, TracerKind::Bvh, TracerKind::Embree,
                                 TracerKind::Voxel};

std::string versionText(uint32_t version) {
    return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                       VK_API_VERSION_PATCH(version));
}

std::string queueText(const vk::QueueFamily& family) {
    std::string text = fmt::format("{} x", family.count);
    if (family.graphics) text += " graphics";
    if (family.compute) text += " compute";
    if (family.transfer) text += " transfer";
    return text;
}

std::string uuidText(const vk::DeviceInfo& info) {
    std::string text;
    for (uint8_t byte : info.uuid)
        text += fmt::format("{:02x}", byte);
    return text;
}

double inGiB(uint64_t bytes) {
    return static_cast<double>(bytes) / (1024.0 * 1024.0 * 1024.0);
}

std::string joined(const std::vector<std::string>& words, const char* between) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : between) + word;
    return text;
}

// Returns the tracers that a device can run. One that lacks what Relume needs runs nothing, whatever the
// tracers ask for.
std::vector<std::string> allowedTracers(const vk::DeviceInfo& info) {
    std::vector<std::string> names;
    if (!info.missing.empty()) return names;
    for (TracerKind kind : kKinds)
        if (tracerProblem(kind, info).empty()) names.emplace_back(tracerName(kind));
    return names;
}

nlohmann::json toJson(const vk::DeviceInfo& info) {
    nlohmann::json queues = nlohmann::json::array();
    for (const vk::QueueFamily& family : info.queues)
        queues.push_back({{"count", family.count},
                          {"graphics", family.graphics},
                          {"compute", family.compute},
                          {"transfer", family.transfer}});
    nlohmann::json json = {{"index", info.index},
                           {"name", info.name},
                           {"type", vk::deviceTypeName(info.type)},
                           {"driver", info.driver},
                           {"vulkan", versionText(info.apiVersion)},
                           {"uuid", uuidText(info)},
                           {"memory_bytes", info.deviceMemory},
                           {"free_memory_bytes", info.freeMemory},
                           {"queues", queues},
                           {"ray_tracing_pipeline", info.rayTracingPipeline},
                           {"ray_query", info.rayQuery},
                           {"external_memory", info.externalMemory},
                           {"missing", info.missing},
                           {"tracers", allowedTracers(info)}};
    if (info.missing.empty()) {
        std::string why;
        json["auto_tracer"] = tracerName(chooseTracer(info, why));
        json["auto_reason"] = why;
    }
    return json;
}

void printDetails(const vk::DeviceInfo& info) {
    std::vector<std::string> queues, tracers;
    for (const vk::QueueFamily& family : info.queues)
        queues.push_back(queueText(family));
    for (TracerKind kind : kKinds) {
        const std::string problem = tracerProblem(kind, info);
        tracers.push_back(
            fmt::format("{:<7} {}", tracerName(kind), problem.empty() ? "yes" : "no: " + problem));
    }
    const auto yesOrNo = [](bool has) { return has ? "yes" : "no"; };
    fmt::print("\ndevice {}: {}\n", info.index, info.name);
    fmt::print("  driver                {}\n", info.driver.empty() ? "unknown" : info.driver);
    fmt::print("  queues                {}\n", joined(queues, "; "));
    fmt::print("  ray tracing pipeline  {}\n", yesOrNo(info.rayTracingPipeline));
    fmt::print("  ray query             {}\n", yesOrNo(info.rayQuery));
    fmt::print("  external memory       {}\n", yesOrNo(info.externalMemory));
    if (!info.missing.empty()) {
        fmt::print("  cannot be used, lacks {}\n", joined(info.missing, ", "));
        return;
    }
    std::string why;
    const TracerKind kind = chooseTracer(info, why);
    fmt::print("  tracers               {}\n", joined(tracers, "\n                        "));
    fmt::print("  --tracer auto takes   {} ({})\n", tracerName(kind), why);
}

void printTable(const std::vector<vk::DeviceInfo>& infos) {
    size_t width = 4;
    for (const vk::DeviceInfo& info : infos)
        width = std::max(width, info.name.size());
    fmt::print("{:<3} {:<{}}  {:<10}  {:<8}  {:>10}  {:>10}  {}\n", "#", "name", width, "type", "vulkan",
               "memory", "free", "tracers");
    for (const vk::DeviceInfo& info : infos) {
        const std::vector<std::string> tracers = allowedTracers(info);
        fmt::print("{:<3} {:<{}}  {:<10}  {:<8}  {:>6.1f} GiB  {:>6.1f} GiB  {}\n", info.index, info.name,
                   width, vk::deviceTypeName(info.type), versionText(info.apiVersion),
                   inGiB(info.deviceMemory), inGiB(info.freeMemory),
                   tracers.empty() ? "none" : joined(tracers, " "));
    }
    for (const vk::DeviceInfo& info : infos)
        printDetails(info);
}

void listAll(bool json) {
    const std::vector<vk::DeviceInfo> infos = vk::listDevices();
    const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    if (infos.empty())
        spdlog::warn("no Vulkan device: install libvulkan1 and mesa-vulkan-drivers or the GPU's driver");
    if (json) {
        nlohmann::json devices = nlohmann::json::array();
        for (const vk::DeviceInfo& info : infos)
            devices.push_back(toJson(info));
        fmt::print("{}\n", nlohmann::json{{"devices", devices}, {"cpu", {{"threads", threads}}}}.dump(2));
        return;
    }
    if (!infos.empty()) printTable(infos);
    fmt::print("\ncpu: {} threads for tracer embree\n", threads);
}

} // namespace

void addDevicesCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("devices", "List Vulkan devices and the tracers that each allows");
    const auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "Print JSON");
    command->callback([json] { listAll(*json); });
}

} // namespace relume
