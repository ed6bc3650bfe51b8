#include "app/edit/furnishing_options.h"

#include "app/text/option_checks.h"
#include "assets/base/error.h"

#include <CLI/CLI.hpp>

namespace relume {

void addFurnishingOptions(CLI::App& command, Furnishing& furnishing) {
    command.add_flag(
        "--unwrap,--no-unwrap{false}", furnishing.unwrap,
        "Make lightmap UVs for meshes that have no usable ones (default), or let these receive no "
        "light");
    command
        .add_option("--density", furnishing.density,
                    "Texels per metre of UVs that are made (default: what fits the lightmap); where no size "
                    "is given, the lightmap is as large as they need")
        ->check(numberAbove(0, 1e6));
    command.add_flag("--daylight,--no-daylight{false}", furnishing.daylight,
                     "Light a level in which nothing shines by a preview sun and sky (default), or by a lamp "
                     "where no sky is seen; or leave it dark");
    command.add_flag("--strict", furnishing.strict,
                     "Fail where lightmap UVs or light are missing, instead of making them");
}

void checkFurnishing(const Furnishing& furnishing) {
    if (!furnishing.unwrap && furnishing.density > 0)
        throw UsageError("--density: not with --no-unwrap, as it is of UVs that are made");
}

} // namespace relume
