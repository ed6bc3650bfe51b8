# Draws the level that is open to an OpenEXR file, in cd/m^2:
#
#     blender -b -P level.py -P show_level.py -- PICTURE.exr
#
# What shines is seen itself; no light is followed on.
import sys

import bpy

scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 4
scene.cycles.use_denoising = False
scene.cycles.max_bounces = 0
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 240, 150, 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = sys.argv[sys.argv.index("--") + 1]
bpy.ops.render.render(write_still=True)
