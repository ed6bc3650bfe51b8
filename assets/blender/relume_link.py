# SPDX-License-Identifier: MIT
"""Shows the scene in Relume while one works in Blender (3.4 or newer), and takes the baked lightmap back.

Edit > Preferences > Add-ons > Install... takes this file. Its panel stands in the 3D view's sidebar, tab Relume:
- Start writes the scene beside the .blend file (room.relume.glb) and opens Relume on it.
- Every save writes it anew, and so does a change while one works, where that is switched on. Relume follows
  what changed: a moved lamp costs its own light only.
- Take lightmap shows the lightmap that Relume exported on all meshes that have a second UV map, the lightmap's.

Without a window: blender -b room.blend -P relume_link.py -- OUT.glb
With --mean-sky behind it the level is one file: a picture of the sky becomes its mean colour.
"""
import math
import os
import shutil
import subprocess
import sys

import bpy
import numpy
from mathutils import Matrix

bl_info = {
    "name": "Relume link",
    "description": "Live lightmaps of the scene in Relume",
    "author": "Relume",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Relume",
    "category": "Import-Export",
}

LUMENS_PER_WATT = 683.0  # of green light of 555 nm, by which glTF's exporter converts, too
# A light shines along its -Z, and glTF's exporter turns objects so that their Y becomes -Z.
LIGHT_AXES = Matrix.Rotation(-math.pi / 2, 4, "X")


def area_light(light, scale):
    """Returns an area light as Relume's extras have it [m, cd/m^2]. `scale` is its object's, along X and Y."""
    size = light.size * scale[0], (light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size) * scale[1]
    round_one = light.shape in {"DISK", "ELLIPSE"}
    area = size[0] * size[1] * (math.pi / 4 if round_one else 1)
    found = {
        "name": light.name,
        "color": list(light.color),
        # Blender's area lights have P / (4 A), as if a sphere of that power were seen from one side.
        "intensity": light.energy * LUMENS_PER_WATT / (4 * max(area, 1e-12)),
    }
    if round_one:  # an ellipse becomes the disc of its area
        return {**found, "type": "disc", "radius": math.sqrt(area / math.pi)}
    return {**found, "type": "rectangle", "size": list(size)}


def linked_node(socket, kind):
    """Returns the node of a kind that a socket is linked to, or None."""
    for link in socket.links:
        if link.from_node.type == kind:
            return link.from_node
    return None


def mean_color(image):
    """Returns the mean of an equirectangular picture over the sphere, linear."""
    width, height, channels = *image.size, image.channels
    if width * height == 0:
        return [0.0, 0.0, 0.0]
    pixels = numpy.empty(width * height * channels, numpy.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, channels)
    weights = numpy.sin(numpy.pi * (numpy.arange(height) + 0.5) / height)  # of a row's solid angle
    found = []
    for c in range(3):
        plane = pixels[:, :, min(c, channels - 1)]
        if not image.is_float:  # 8 bits are sRGB encoded
            plane = numpy.where(plane <= 0.04045, plane / 12.92, ((plane + 0.055) / 1.055) ** 2.4)
        found.append(float((plane.mean(1) * weights).sum() / weights.sum()))
    return found


def has_nodes(thing):
    """Tells whether a material or world is made of nodes: all are from Blender 6.0 on, which does not ask any more."""
    return getattr(thing, "use_nodes", True)


def sky(world, folder):
    """Returns the sky of a world as Relume's extras have it, or None for a dark one.

    A picture stays where it is and is named from `folder`. Without a folder, or where it is no .exr or .hdr file, the sky
    has its mean colour.
    """
    if world is None:
        return None
    if not has_nodes(world):
        return {"color": list(world.color), "intensity": LUMENS_PER_WATT} if any(world.color) else None
    background = next((node for node in world.node_tree.nodes if node.type == "BACKGROUND"), None)
    if background is None:
        return None
    strength = background.inputs["Strength"].default_value * LUMENS_PER_WATT
    picture = linked_node(background.inputs["Color"], "TEX_ENVIRONMENT")
    if picture is None or picture.image is None:
        color = list(background.inputs["Color"].default_value)[:3]
        return {"color": color, "intensity": strength} if strength > 0 and any(color) else None
    source = bpy.path.abspath(picture.image.filepath)
    if folder is None or not source.lower().endswith((".exr", ".hdr")) or not os.path.isfile(source):
        return {"color": mean_color(picture.image), "intensity": strength}
    mapping = linked_node(picture.inputs["Vector"], "MAPPING")
    turned = mapping.inputs["Rotation"].default_value[2] if mapping else 0.0
    # The middle of a picture lies in +X here and in +Y (glTF's -Z) there; a mapping turns what is looked up.
    return {"color": [1, 1, 1], "intensity": strength, "file": os.path.relpath(source, folder).replace(os.sep, "/"), "rotation": -math.pi / 2 - turned}


def kept(thing):
    """Returns a copy of what a thing has for Relume."""
    value = thing.get("relume")
    return value.to_dict() if hasattr(value, "to_dict") else value


class Dressed:
    """Gives the scene what glTF's exporter does not write by itself, as long as a `with` block lasts."""

    def __init__(self, folder):
        self.folder = folder

    def __enter__(self):
        scene = bpy.context.scene
        self.added, self.shown, self.strengths = [], [], []
        self.former = kept(scene)
        self.lights = [(light, kept(light)) for light in bpy.data.lights]
        try:
            self.dress(scene)
        except BaseException:
            self.__exit__()
            raise
        return self

    def dress(self, scene):
        for thing in [thing for thing in scene.objects if thing.type == "LIGHT" and thing.visible_get()]:
            if thing.data.type == "AREA":
                self.add_area(scene, thing)
        shines = sky(scene.world, self.folder)
        if shines:
            scene["relume"] = {"sky": shines}
        elif self.former is not None:
            del scene["relume"]
        for light, _ in self.lights:
            if light.type in {"POINT", "SPOT"}:
                light["relume"] = {"radius": light.shadow_soft_size}
            elif light.type == "SUN":
                light["relume"] = {"angle": light.angle}
        for material in bpy.data.materials:  # the exporter follows the surface, not the lightmap that is shown for it
            if not has_nodes(material):
                continue
            self.brighten(material.node_tree.nodes)
            if "Relume lightmap" in material.node_tree.nodes and "relume_surface" in material:
                nodes, links = material.node_tree.nodes, material.node_tree.links
                entry = nodes[material["relume_output"]].inputs["Surface"]
                self.shown.append((links, entry, entry.links[0].from_socket))
                links.new(nodes[material["relume_surface"]].outputs[0], entry)

    def brighten(self, nodes):
        """Brings what glows to the same unit as the lamps: the exporter takes watts for candelas there."""
        for node in nodes:
            name = {"BSDF_PRINCIPLED": "Emission Strength", "EMISSION": "Strength"}.get(node.type)
            if name and name in node.inputs and not node.inputs[name].is_linked:
                self.strengths.append((node.inputs[name], node.inputs[name].default_value))
                node.inputs[name].default_value *= LUMENS_PER_WATT

    def add_area(self, scene, thing):
        place, turn, scale = thing.matrix_world.decompose()
        empty = bpy.data.objects.new(thing.name + " (area)", None)
        self.added.append(empty)
        empty["relume"] = {"areaLight": {**area_light(thing.data, scale), "name": thing.name}}
        empty.matrix_world = Matrix.Translation(place) @ turn.to_matrix().to_4x4() @ LIGHT_AXES
        scene.collection.objects.link(empty)

    def __exit__(self, *_):
        for socket, strength in self.strengths:
            socket.default_value = strength
        for links, entry, socket in self.shown:
            links.new(socket, entry)
        for empty in self.added:
            bpy.data.objects.remove(empty)
        restore(bpy.context.scene, self.former)
        for light, former in self.lights:
            restore(light, former)


def restore(thing, former):
    """Gives a thing back what it had for Relume."""
    if former is not None:
        thing["relume"] = former
    elif "relume" in thing:
        del thing["relume"]


def write_level(path, mean_sky=False):
    """Writes the scene as Relume reads it, whole or not at all."""
    whole, part = os.path.abspath(path), os.path.abspath(path)[: -len(".glb")] + ".part.glb"
    options = {
        "filepath": part,
        "export_format": "GLB",
        "export_lights": True,
        "export_cameras": True,
        "export_extras": True,
        "use_visible": True,
        "export_apply": True,
        "export_animations": False,
        "export_current_frame": True,
        "use_active_scene": True,
        "export_import_convert_lighting_mode": "SPEC",
    }
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    with Dressed(None if mean_sky else os.path.dirname(whole)):
        bpy.ops.export_scene.gltf(**{name: value for name, value in options.items() if name in known})
    os.replace(part, whole)


def level_path():
    """Returns where the level of the open file stands, "" for a file that was never saved."""
    return bpy.data.filepath[: -len(".blend")] + ".relume.glb" if bpy.data.filepath else ""


def show_lightmap(path):
    """Shows a lightmap on all meshes that have a second UV map, in place of their materials' surfaces.

    That map has to be the lightmap's: an atlas of all meshes together. Returns how many meshes have none.
    """
    picture = bpy.data.images.load(path, check_existing=True)
    picture.reload()
    picture.colorspace_settings.name = "Non-Color"
    without = 0
    for thing in [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]:
        if len(thing.data.uv_layers) < 2:
            without += 1
            continue
        for slot in thing.material_slots:
            if slot.material and has_nodes(slot.material):
                light_material(slot.material, picture, thing.data.uv_layers[1].name)
    return without


def light_material(material, picture, uv_map):
    """Shows lightmap x base colour; a second call replaces the picture. What was shown before stays in the nodes."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    if "Relume lightmap" in nodes:
        nodes["Relume lightmap"].image = picture
        return
    surface = next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None)
    output = next((node for node in nodes if node.type == "OUTPUT_MATERIAL"), None)
    if surface is None or output is None or not output.inputs["Surface"].is_linked:
        return
    material["relume_surface"] = output.inputs["Surface"].links[0].from_node.name
    material["relume_output"] = output.name
    texture = nodes.new("ShaderNodeTexImage")
    texture.name = texture.label = "Relume lightmap"
    texture.image = picture
    uv = nodes.new("ShaderNodeUVMap")
    uv.uv_map = uv_map
    links.new(uv.outputs[0], texture.inputs[0])
    product = nodes.new("ShaderNodeVectorMath")
    product.operation = "MULTIPLY"
    links.new(texture.outputs["Color"], product.inputs[0])
    base = surface.inputs["Base Color"]
    if base.is_linked:
        links.new(base.links[0].from_socket, product.inputs[1])
    else:
        product.inputs[1].default_value = list(base.default_value)[:3]
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 1 / LUMENS_PER_WATT  # the lightmap is in cd/m^2, Blender's light in watts
    links.new(product.outputs[0], emission.inputs["Color"])
    links.new(emission.outputs[0], output.inputs["Surface"])


class RELUME_OT_start(bpy.types.Operator):
    """Write the scene and open Relume on it"""

    bl_idname = "relume.start"
    bl_label = "Start"

    def execute(self, context):
        path = level_path()
        if not path:
            self.report({"ERROR"}, "Save the .blend file first: the level is written beside it")
            return {"CANCELLED"}
        program = shutil.which(context.scene.relume_program)
        if program is None:
            self.report({"ERROR"}, f"'{context.scene.relume_program}' is not there: name Relume's program")
            return {"CANCELLED"}
        write_level(path)
        subprocess.Popen([program, "view", path])
        return {"FINISHED"}


class RELUME_OT_lightmap(bpy.types.Operator):
    """Show the lightmap that Relume exported on all meshes that have a second UV map"""

    bl_idname = "relume.lightmap"
    bl_label = "Take lightmap"
    filepath: bpy.props.StringProperty(subtype="FILE_PATH")

    def invoke(self, context, _):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, _):
        if not os.path.isfile(self.filepath):
            self.report({"ERROR"}, f"{self.filepath}: no such file: export a lightmap in Relume (Ctrl+E)")
            return {"CANCELLED"}
        without = show_lightmap(self.filepath)
        if without:
            self.report({"WARNING"}, f"{without} meshes have no second UV map: in Relume, File > Export for > blender writes the level with one")
        return {"FINISHED"}


class RELUME_PT_panel(bpy.types.Panel):
    bl_label = "Relume"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Relume"

    def draw(self, context):
        layout = self.layout
        layout.prop(context.scene, "relume_program")
        layout.operator("relume.start")
        layout.prop(context.scene, "relume_live")
        layout.operator("relume.lightmap")


@bpy.app.handlers.persistent
def on_save(*_):
    """Writes the level anew where there is one: Start has made the first."""
    path = level_path()
    if not path or not os.path.exists(path):
        return
    try:
        write_level(path)
    except Exception as error:  # a save must not fail by it, nor the timer end
        print(f"relume: {path}: was not written ({error})", file=sys.stderr)


SECONDS = 1.0  # between two looks for changes while one works
changed = False


@bpy.app.handlers.persistent
def on_change(_, graph):
    global changed
    changed = changed or any(update.is_updated_transform or update.is_updated_geometry or update.is_updated_shading
                             for update in graph.updates)


def write_what_changed():
    global changed
    windows = bpy.context.window_manager.windows
    if changed and len(windows) > 0:
        with bpy.context.temp_override(window=windows[0]):  # a timer has none, and the exporter asks for it
            if bpy.context.scene.relume_live and bpy.context.mode == "OBJECT":
                on_save()
                bpy.context.view_layer.update()  # what the export itself changed is told now, and is no change
                changed = False
    return SECONDS


CLASSES = (RELUME_OT_start, RELUME_OT_lightmap, RELUME_PT_panel)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.relume_program = bpy.props.StringProperty(name="Program", default="relume", subtype="FILE_PATH")
    bpy.types.Scene.relume_live = bpy.props.BoolProperty(name="While I work", description="Write changes each second")
    bpy.app.handlers.save_post.append(on_save)
    bpy.app.handlers.depsgraph_update_post.append(on_change)
    bpy.app.timers.register(write_what_changed, persistent=True)


def unregister():
    bpy.app.timers.unregister(write_what_changed)
    bpy.app.handlers.depsgraph_update_post.remove(on_change)
    bpy.app.handlers.save_post.remove(on_save)
    del bpy.types.Scene.relume_live
    del bpy.types.Scene.relume_program
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if bpy.app.background and not bpy.data.filepath:  # Blender goes on with an empty scene
        sys.exit("relume: the .blend file cannot be read")
    if bpy.app.background and given and given[1:] in ([], ["--mean-sky"]) and given[0].endswith(".glb"):
        write_level(given[0], mean_sky=len(given) == 2)
    elif bpy.app.background:
        sys.exit("usage: blender -b FILE.blend -P relume_link.py -- OUT.glb [--mean-sky]")
    else:
        register()
