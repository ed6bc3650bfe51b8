#include "app/edit/page_options.h"

#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/model/lightmap_pages.h"

#include <fmt/format.h>

namespace relume {
namespace {

constexpr const char* kByDensity = "auto";

} // namespace

CLI::Option* addPagesOption(CLI::App& command, std::string& pages) {
    return command
        .add_option("--pages", pages,
                    "Pages of the lightmap, each of --size; an object lies on one. auto: as many as "
                    "--density needs")
        ->check(wholeFromOr(1, kMostPages, kByDensity));
}

std::optional<uint32_t> askedPages(const std::string& pages) {
    if (pages.empty()) return std::nullopt;
    return pages == kByDensity ? 0 : static_cast<uint32_t>(std::stoul(pages));
}

void checkPages(uint32_t pages, uint32_t size, double density) {
    if (pages == 0 && !(density > 0.0))
        throw UsageError("--pages auto: needs a --density to choose the number by");
    if (pages == 0 && size == 0) throw UsageError("--pages auto: needs a --size, that of each page");
    if (pages != 1 && size % kPageStep != 0)
        throw UsageError(
            fmt::format("--pages: pages consist of tiles of {0} x {0} texels, so that their --size is a "
                        "multiple of {0}, not {1}: give {2}",
                        kPageStep, size, (size + kPageStep - 1) / kPageStep * kPageStep));
}

} // namespace relume
