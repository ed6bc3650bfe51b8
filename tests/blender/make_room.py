"""Makes a small room in Blender and saves it, as designers do: blender -b -P make_room.py -- OUT.blend"""
import sys

import bpy


def paint(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (*color, 1)
    surface.inputs["Metallic"].default_value = 0
    return material


def named(name):
    bpy.context.object.name = name
    return bpy.context.object


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add(size=6)
named("Floor").data.materials.append(paint("Floor", (0.6, 0.6, 0.6)))
bpy.ops.mesh.primitive_cube_add(size=1, location=(1, 0.5, 0.5))
glowing = paint("Box", (0.8, 0.2, 0.2))
glow = glowing.node_tree.nodes["Principled BSDF"].inputs
color = "Emission Color" if "Emission Color" in glow else "Emission"  # as Blender names it since 4.0, and before
glow[color].default_value, glow["Emission Strength"].default_value = (1, 1, 1, 1), 2
named("Box").data.materials.append(glowing)
bpy.context.object.data.uv_layers.new(name="Lightmap")
bpy.ops.object.light_add(type="AREA", location=(0, 0, 3), rotation=(0.3, 0, 0))
panel = named("Panel").data
panel.shape, panel.size, panel.size_y, panel.energy = "RECTANGLE", 1, 0.5, 100
bpy.ops.object.light_add(type="POINT", location=(-1, 1, 2))
bulb = named("Bulb").data
bulb.name, bulb.energy, bulb.shadow_soft_size = "Bulb", 50, 0.1
world = bpy.data.worlds.new("World")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5
bpy.context.scene.world = world
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])
