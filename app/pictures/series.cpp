#include "app/pictures/series.h"

#include "app/text/interrupt.h"
#include "assets/base/error.h"
#include "renderer/camera_path.h"
#include "renderer/caption.h"

#include <algorithm>
#include <cmath>

namespace relume {

CameraSeries turnSeries(const ViewCamera& camera, const Box& bounds, uint32_t count) {
    CameraSeries series{.cameras = turntable(camera, bounds, count), .captions = {}, .title = {}};
    constexpr double kFullTurn = 360.0; // [degrees]
    for (uint32_t i = 0; i < count; ++i)
        series.captions.push_back(fmt::format("turned by {:.0f} degrees", kFullTurn * i / count));
    return series;
}

CameraSeries pathSeries(std::span<const ViewCamera> stops, double seconds, double rate) {
    const double steps = std::max(1.0, std::round(seconds * rate));
    CameraSeries series{
        .cameras = cameraPath(stops, static_cast<uint32_t>(steps) + 1), .captions = {}, .title = {}};
    captionByTime(series, seconds);
    return series;
}

void captionByTime(CameraSeries& series, double seconds) {
    const double steps = std::max(1.0, static_cast<double>(series.cameras.size()) - 1);
    series.captions.clear();
    for (size_t i = 0; i < series.cameras.size(); ++i)
        series.captions.push_back(
            fmt::format("{:.1f} of {:.1f} s", seconds * static_cast<double>(i) / steps, seconds));
}

void takeSeries(PictureStudio& studio, const LightmapTexture& lightmap, DrawSettings draw,
                const CameraSeries& series, FrameWriter& writer) {
    for (size_t i = 0; i < series.cameras.size(); ++i) {
        if (InterruptGuard::requested() && writer.keepsFrames() && writer.count() > 0)
            throw Error(fmt::format("interrupted: {} frames were written", writer.count()));
        stopIfInterrupted();
        studio.setCamera(series.cameras[i]);
        FloatImage picture = studio.take(lightmap, draw);
        if (!series.title.empty()) drawCaption(picture, {series.title, series.captions[i]});
        writer.write(picture, 1);
        if (showsLight(draw.view)) draw.exposure = studio.exposure();
    }
    writer.finish();
}

} // namespace relume
