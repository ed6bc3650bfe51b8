#include "app/viewer/state/picture_notice.h"

namespace relume {

std::optional<PictureNotice> pictureNotice(const PictureFacts& facts) {
    if (facts.phase == BakeStatus::Phase::Failed)
        return PictureNotice{.title = "No light can be baked", .text = facts.doing, .mend = {}};
    if (facts.flat && !facts.map)
        return PictureNotice{.title = "There is no lightmap yet",
                             .text = "It is shown as soon as the bake has one.",
                             .mend = Action::UvTexture};
    if (!facts.flat && facts.objects == 0)
        return PictureNotice{.title = "There is nothing to be seen",
                             .text = "The scene has no surfaces: export it with its meshes.",
                             .mend = {}};
    if (!facts.flat && facts.hidden == facts.objects)
        return PictureNotice{.title = "There is nothing to be seen",
                             .text = "All objects are hidden.",
                             .mend = Action::ShowObjects};
    return std::nullopt;
}

} // namespace relume
