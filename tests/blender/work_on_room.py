"""Works on a room whose level Relume shows: blender -b ROOM.blend -P work_on_room.py -- ADDON.py LIGHTMAP.exr

Moves a lamp and saves, by which the add-on writes the level anew, and takes a lightmap.
"""
import importlib.util
import sys

import bpy

addon, lightmap = sys.argv[sys.argv.index("--") + 1:]
spec = importlib.util.spec_from_file_location("relume_link", addon)
relume_link = importlib.util.module_from_spec(spec)
spec.loader.exec_module(relume_link)
relume_link.register()
bpy.data.objects["Bulb"].location.x += 0.5
assert relume_link.show_lightmap(lightmap) == 1, "the floor has one UV map only"
assert relume_link.show_lightmap(lightmap) == 1  # again, as after another bake
bpy.ops.wm.save_mainfile()
for material in [bpy.data.materials["Box"]]:
    pictures = [node for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    assert len(pictures) == 1 and pictures[0].image.filepath.endswith("lightmap.exr"), material.name
    output = material.node_tree.nodes["Material Output"]
    assert output.inputs["Surface"].links[0].from_node.type == "EMISSION", material.name
assert "relume" not in bpy.context.scene and "relume" not in bpy.data.lights["Bulb"], "what was added is taken away"
relume_link.unregister()
print("took the lightmap")
