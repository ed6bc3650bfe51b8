"""Makes a room with a light of each kind and writes it in other formats too:

blender -b -P make_lamps.py -- ROOM.blend ROOM.fbx ROOM.obj [ROOM.dae]
"""
import sys

import bpy


def paint(name, strength):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"].inputs
    surface["Base Color"].default_value = (0.6, 0.5, 0.4, 1)
    color = "Emission Color" if "Emission Color" in surface else "Emission"  # as Blender names it since 4.0, and before
    surface[color].default_value = (1, 0.5, 0.25, 1)
    surface["Emission Strength"].default_value = strength
    return material


def lamp(kind, name, place, energy, scale=(1, 1, 1), **values):
    bpy.ops.object.light_add(type=kind, location=place, rotation=(0.3, 0, 0))
    thing = bpy.context.object
    thing.name = thing.data.name = name
    thing.scale, thing.data.energy = scale, energy
    for key, value in values.items():
        setattr(thing.data, key, value)


level, *others = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add(size=6)
bpy.context.object.data.materials.append(paint("Floor", 0))
bpy.ops.mesh.primitive_cube_add(size=1, location=(1, 0.5, 0.5))
bpy.context.object.data.materials.append(paint("Box", 2))
lamp("POINT", "Bulb", (-1, 1, 2), 50, color=(1, 0.5, 0.25))
lamp("SPOT", "Spot", (0, 1, 2), 40, spot_size=1, spot_blend=0.25)
lamp("SUN", "Sun", (0, 0, 5), 3)
lamp("AREA", "Panel", (0, 0, 3), 100, (2, 1, 1), shape="RECTANGLE", size=1, size_y=0.5)
lamp("AREA", "Disc", (2, 0, 3), 60, shape="DISK", size=0.5)
bpy.ops.wm.save_as_mainfile(filepath=level)
for path in others:
    if path.endswith(".fbx"):
        bpy.ops.export_scene.fbx(filepath=path)
    elif path.endswith(".obj"):
        bpy.ops.wm.obj_export(filepath=path)
    elif "collada_export" in dir(bpy.ops.wm):  # Blender is built without it at times
        bpy.ops.wm.collada_export(filepath=path)
