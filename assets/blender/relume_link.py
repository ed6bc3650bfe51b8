# SPDX-License-Identifier: MIT
"""Shows the scene in Relume while one works in Blender (3.4 or newer), and takes the baked lightmap back.

Edit > Preferences > Add-ons > Install... takes this file. Its panel stands in the 3D view's sidebar, tab Relume:
- Start writes the scene beside the .blend file (room.relume.glb) and opens Relume on it.
- Every save writes it anew, and so does a change while one works, where that is switched on. Relume follows
  what changed: a moved lamp costs its own light only.
- Take lightmap reads the lightmap that Relume exported and shows it on all meshes.

Without a window: blender -b room.blend -P relume_link.py -- OUT.glb
With --mean-sky behind it the level is one file: a picture of the sky becomes its mean colour.
"""
import math
import os
import shutil
import subprocess
import sys

import bpy
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
        # A Lambertian emitter of P lumens and area A has P / (pi A).
        "intensity": light.energy * LUMENS_PER_WATT / (math.pi * max(area, 1e-12)),
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
    pixels = list(image.pixels)
    total, weights = [0.0, 0.0, 0.0], 0.0
    for row in range(height):
        weight = math.sin(math.pi * (row + 0.5) / height)  # of a row's solid angle
        line = pixels[row * width * channels:(row + 1) * width * channels]
        for c in range(3):
            total[c] += weight * sum(line[min(c, channels - 1)::channels])
        weights += weight * width
    return [one / weights for one in total] if weights else total


def sky(world, folder):
    """Returns the sky of a world as Relume's extras have it, or None for a dark one.

    A picture is copied to `folder`; without one the sky has its mean colour.
    """
    if world is None:
        return None
    if not world.use_nodes:
        return {"color": list(world.color), "intensity": LUMENS_PER_WATT} if any(world.color) else None
    background = next((node for node in world.node_tree.nodes if node.type == "BACKGROUND"), None)
    if background is None:
        return None
    strength = background.inputs["Strength"].default_value * LUMENS_PER_WATT
    picture = linked_node(background.inputs["Color"], "TEX_ENVIRONMENT")
    if picture is None or picture.image is None:
        color = list(background.inputs["Color"].default_value)[:3]
        return {"color": color, "intensity": strength} if strength > 0 and any(color) else None
    if folder is None:
        return {"color": mean_color(picture.image), "intensity": strength}
    source = bpy.path.abspath(picture.image.filepath)
    if not source.lower().endswith((".exr", ".hdr")) or not os.path.isfile(source):
        print(f"relume: the sky's picture '{source}' is no .exr or .hdr file: the sky is left out", file=sys.stderr)
        return None
    target = os.path.join(folder, os.path.basename(source))
    if os.path.abspath(source) != os.path.abspath(target):
        shutil.copyfile(source, target)
    mapping = linked_node(picture.inputs["Vector"], "MAPPING")
    turned = mapping.inputs["Rotation"].default_value[2] if mapping else 0.0
    # The middle of a picture lies in +X here and in +Y (glTF's -Z) there; a mapping turns what is looked up.
    return {"color": [1, 1, 1], "intensity": strength, "file": os.path.basename(source), "rotation": -math.pi / 2 - turned}


class Dressed:
    """Gives the scene what glTF's exporter does not write by itself, as long as a `with` block lasts."""

    def __init__(self, folder):
        self.folder = folder
        self.added = []

    def __enter__(self):
        scene = bpy.context.scene
        for thing in [thing for thing in scene.objects if thing.type == "LIGHT" and thing.visible_get()]:
            if thing.data.type == "AREA":
                self.add_area(scene, thing)
        self.former = scene.get("relume")
        shines = sky(scene.world, self.folder)
        if shines:
            scene["relume"] = {"sky": shines}
        elif self.former is not None:
            del scene["relume"]
        self.radii = [(light, light.get("relume")) for light in bpy.data.lights]
        for light, _ in self.radii:
            if light.type in {"POINT", "SPOT"}:
                light["relume"] = {"radius": light.shadow_soft_size}
            elif light.type == "SUN":
                light["relume"] = {"angle": light.angle}
        return self

    def add_area(self, scene, thing):
        place, turn, scale = thing.matrix_world.decompose()
        empty = bpy.data.objects.new(thing.name + " (area)", None)
        empty["relume"] = {"areaLight": {**area_light(thing.data, scale), "name": thing.name}}
        empty.matrix_world = Matrix.Translation(place) @ turn.to_matrix().to_4x4() @ LIGHT_AXES
        scene.collection.objects.link(empty)
        self.added.append(empty)

    def __exit__(self, *_):
        scene = bpy.context.scene
        for empty in self.added:
            bpy.data.objects.remove(empty)
        restore(scene, self.former)
        for light, former in self.radii:
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
    """Puts a lightmap on all meshes: an image node on the second UV map, beside what the materials are."""
    picture = bpy.data.images.load(path, check_existing=True)
    picture.reload()
    picture.colorspace_settings.name = "Non-Color"
    for material in {slot.material for thing in bpy.context.scene.objects for slot in thing.material_slots if slot.material}:
        if material.use_nodes:
            light_material(material, picture)


def light_material(material, picture):
    """Adds lightmap x base colour to what a material emits; a second call replaces the picture."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    if "Relume lightmap" in nodes:
        nodes["Relume lightmap"].image = picture
        return
    surface = next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None)
    output = next((node for node in nodes if node.type == "OUTPUT_MATERIAL"), None)
    if surface is None or output is None:
        return
    texture = nodes.new("ShaderNodeTexImage")
    texture.name = texture.label = "Relume lightmap"
    texture.image = picture
    uv = nodes.new("ShaderNodeUVMap")  # without a name: the one that is active for rendering
    maps = next((thing.data.uv_layers for thing in bpy.context.scene.objects
                 if thing.type == "MESH" and material.name in thing.data.materials), [])
    if len(maps) > 1:
        uv.uv_map = maps[1].name
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
    """Show the lightmap that Relume exported on all meshes"""

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
        show_lightmap(self.filepath)
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
    if path and os.path.exists(path):
        write_level(path)


SECONDS = 1.0  # between two looks for changes while one works
changed = False


@bpy.app.handlers.persistent
def on_change(scene, graph):
    global changed
    changed = changed or any(update.is_updated_transform or update.is_updated_geometry or update.is_updated_shading
                             for update in graph.updates)


def write_what_changed():
    global changed
    scene = bpy.context.scene
    if changed and scene.relume_live and bpy.context.mode == "OBJECT":
        on_save()
        changed = False  # what the export itself changed is no change
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
