#include "app/pictures/turn.h"

#include "app/text/interrupt.h"
#include "renderer/scene_geometry.h"

namespace relume {

void takeTurn(PictureStudio& studio, const LightmapTexture& lightmap, DrawSettings draw,
              const WorldMesh& mesh, uint32_t count, FrameWriter& writer) {
    for (const ViewCamera& camera : turntable(studio.camera(), boundsOf(mesh), count)) {
        stopIfInterrupted();
        studio.setCamera(camera);
        writer.write(studio.take(lightmap, draw), 1);
        if (showsLight(draw.view)) draw.exposure = studio.exposure();
    }
    writer.finish();
}

} // namespace relume
