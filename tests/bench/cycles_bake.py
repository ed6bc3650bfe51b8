"""Bakes a scene's lightmap with Blender's Cycles on the CPU and says what it cost.

blender -b --factory-startup -P cycles_bake.py -- SCENE.glb SIZE BOUNCES SAMPLES,... SEED OUT_PREFIX

Writes OUT_PREFIX-SAMPLES.exr (lighting = irradiance / pi, as relume's; row 0 is v = 0) and a line per bake on standard
output: "cycles SAMPLES CPU_SECONDS WALL_SECONDS". CPU seconds are this process's user and system time during the bake
itself, its scene synchronisation and BVH included, Blender's start and the import of the scene excluded.

OUT_PREFIX-mask.exr is 1 in texels that are covered as a whole and in which nothing stands. Of others Cycles takes the mean
over the texel, black parts inside something and beyond the chart included, relume that over the part that can be seen, and no
number of samples makes these equal. A texel counts where all of PARTS x PARTS texels in its place see the fronts of
surfaces, or the sky, in three of five directions or more: relume takes what sees fewer to lie inside something.
"""

import json
import math
import os
import sys
import time

import bpy
import numpy
from mathutils import Matrix

PARTS = 4  # along a texel's edge, to tell what is covered as a whole
FRONTS = 0.6  # of the directions of each

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Debian 12's Blender imports glTF by a name that its numpy no longer has


def linked(socket):
    """Returns what feeds an input: the output that is linked to it, or None where the input's own value counts."""
    return socket.links[0].from_socket if socket.is_linked else None


def diffuse(material):
    """Rebuilds an imported material as relume's model: Lambert's reflection and one-sided emission, cut out by its mask.
    What blends with less than half is a pane, which light passes. Returns its brightest emission."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    principled = next(n for n in nodes if n.type == "BSDF_PRINCIPLED")
    colour = principled.inputs["Base Color"]
    alpha = principled.inputs["Alpha"]
    emission = tuple(principled.inputs["Emission"].default_value)
    strength = principled.inputs["Emission Strength"].default_value
    output = next(n for n in nodes if n.type == "OUTPUT_MATERIAL")
    reflection = nodes.new("ShaderNodeBsdfDiffuse")
    if linked(colour):
        links.new(linked(colour), reflection.inputs["Color"])
    else:
        reflection.inputs["Color"].default_value = tuple(colour.default_value)
    shader = reflection.outputs["BSDF"]
    if strength > 0 and max(emission[:3]) > 0:
        light = nodes.new("ShaderNodeEmission")
        light.inputs["Color"].default_value = emission
        geometry = nodes.new("ShaderNodeNewGeometry")
        front = nodes.new("ShaderNodeMath")
        front.operation = "MULTIPLY_ADD"  # strength * (1 - backfacing)
        links.new(geometry.outputs["Backfacing"], front.inputs[0])
        front.inputs[1].default_value = -strength
        front.inputs[2].default_value = strength
        links.new(front.outputs["Value"], light.inputs["Strength"])
        both = nodes.new("ShaderNodeAddShader")
        links.new(shader, both.inputs[0])
        links.new(light.outputs["Emission"], both.inputs[1])
        shader = both.outputs["Shader"]
    pane = material.blend_method == "BLEND" and not linked(alpha) and alpha.default_value < 0.5
    if pane or (material.blend_method == "CLIP" and linked(alpha)):
        nothing = nodes.new("ShaderNodeBsdfTransparent")
        cut = nodes.new("ShaderNodeMixShader")
        links.new(nothing.outputs["BSDF"], cut.inputs[1])
        links.new(shader, cut.inputs[2])
        cut.inputs[0].default_value = 0.0
        if not pane:
            solid = nodes.new("ShaderNodeMath")
            solid.operation = "GREATER_THAN"
            links.new(linked(alpha), solid.inputs[0])
            solid.inputs[1].default_value = material.alpha_threshold
            links.new(solid.outputs["Value"], cut.inputs[0])
        shader = cut.outputs["Shader"]
    nodes.remove(principled)
    links.new(shader, output.inputs["Surface"])
    material["pane"] = pane
    return max(emission[:3]) * strength


def scene_json(path):
    """Returns the JSON of a GLB, whose lights have units that the importer changes."""
    with open(path, "rb") as file:
        head = file.read(20)
        return json.loads(file.read(int.from_bytes(head[12:16], "little")))


def shine(path):
    """Gives lights what the file says, a watt of Blender's being a lumen: a point of P W has P / 4 pi cd, an area light
    P / 4 A cd/m^2, a sun P lux. Soft extents, area lights and the sky stand in relume's extras."""
    gltf = scene_json(path)
    lights = gltf.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    for node in gltf.get("nodes", []):
        index = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
        if index is not None:
            light, own = bpy.data.objects[node["name"]].data, lights[index].get("extras", {}).get("relume", {})
            intensity = lights[index].get("intensity", 1.0)
            if light.type == "SUN":
                light.energy, light.angle = intensity, own.get("angle", 0.0)
            else:
                light.energy, light.shadow_soft_size = intensity * 4 * math.pi, own.get("radius", 0.0)
        area = node.get("extras", {}).get("relume", {}).get("areaLight")
        if area:
            light = bpy.data.lights.new(area["name"], "AREA")
            if area["type"] == "disc":
                light.shape, light.size = "DISK", 2 * area["radius"]
                extent = math.pi * area["radius"] ** 2
            else:
                light.shape, (light.size, light.size_y) = "RECTANGLE", area["size"]
                extent = area["size"][0] * area["size"][1]
            light.color = area.get("color", [1, 1, 1])
            light.energy = 4 * extent * area.get("intensity", 1.0)
            lamp = bpy.data.objects.new(area["name"], light)
            # The importer turns a node without a light so that the node's -Z is +Y.
            lamp.matrix_world = bpy.data.objects[node["name"]].matrix_world @ Matrix.Rotation(math.pi / 2, 4, "X")
            bpy.context.collection.objects.link(lamp)
    sky = gltf["scenes"][gltf.get("scene", 0)].get("extras", {}).get("relume", {}).get("sky")
    if sky:
        world = bpy.data.worlds.new("sky")
        world.use_nodes = True
        background = world.node_tree.nodes["Background"]
        background.inputs["Color"].default_value = (*sky.get("color", [1, 1, 1]), 1)
        background.inputs["Strength"].default_value = sky.get("intensity", 1.0)
        bpy.context.scene.world = world


def prepare(path, size):
    """Imports the scene as one object; returns the image all its materials bake into."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.import_scene.gltf(filepath=path)
    meshes = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    materials = {slot.material for mesh in meshes for slot in mesh.material_slots}
    shine(path)
    brightest = max(diffuse(material) for material in materials)
    print("cycles_bake: %d meshes, %d materials, brightest emission %g" % (len(meshes), len(materials), brightest))
    bpy.ops.object.select_all(action="DESELECT")
    for mesh in meshes:
        mesh.select_set(True)
    bpy.context.view_layer.objects.active = meshes[0]
    bpy.ops.object.join()
    layers = bpy.context.object.data.uv_layers
    layers.active = layers[-1]  # the lightmap's
    layers[-1].active_render = True
    image = bpy.data.images.new("lightmap", size, size, float_buffer=True, is_data=True)
    image.use_half_precision = False
    for material in materials:
        node = material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        material.node_tree.nodes.active = node
    return image


def configure(bounces):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    cycles.transparent_max_bounces = 256  # one after another of the leaves of a tree, and panes
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0  # no light is dropped for being dim
    scene.render.bake.use_pass_direct = scene.render.bake.use_pass_indirect = True
    scene.render.bake.use_pass_color = False
    scene.render.bake.margin = 0


def save(image, path):
    scene = bpy.context.scene
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    settings.exr_codec = "ZIP"
    scene.view_settings.view_transform = "Standard"
    image.save_render(path, scene=scene)


def shine_all(image):
    """Makes every front and the sky of radiance 1, but for panes, which light passes; all of them bake into the image."""
    pane = bpy.data.materials.new("pane")
    pane.use_nodes = True
    nodes, links = pane.node_tree.nodes, pane.node_tree.links
    nothing = nodes.new("ShaderNodeBsdfTransparent")
    links.new(nothing.outputs["BSDF"], next(n for n in nodes if n.type == "OUTPUT_MATERIAL").inputs["Surface"])
    material = bpy.data.materials.new("fronts shine")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.remove(next(n for n in nodes if n.type == "BSDF_PRINCIPLED"))
    output = next(n for n in nodes if n.type == "OUTPUT_MATERIAL")
    geometry, front = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath")
    front.operation = "SUBTRACT"
    front.inputs[0].default_value = 1.0
    links.new(geometry.outputs["Backfacing"], front.inputs[1])
    light, both = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeAddShader")
    links.new(front.outputs["Value"], light.inputs["Strength"])
    black = nodes.new("ShaderNodeBsdfDiffuse")
    links.new(black.outputs["BSDF"], both.inputs[0])
    links.new(light.outputs["Emission"], both.inputs[1])
    links.new(both.outputs["Shader"], output.inputs["Surface"])
    for slot in bpy.context.object.material_slots:
        slot.material = pane if slot.material["pane"] else material
    for each in (material, pane):
        node = each.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        each.node_tree.nodes.active = node
    for lamp in [o for o in bpy.data.objects if o.type == "LIGHT"]:
        bpy.data.objects.remove(lamp)
    world = bpy.data.worlds.new("bright")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.0
    bpy.context.scene.world = world


def save_mask(size, path):
    """Bakes which parts of texels see fronts; what stands in the scene is lost."""
    edge = PARTS * size
    image = bpy.data.images.new("parts", edge, edge, float_buffer=True, is_data=True)
    shine_all(image)
    cycles = bpy.context.scene.cycles
    cycles.samples, cycles.max_bounces, cycles.diffuse_bounces = 64, 1, 1
    bpy.ops.object.bake(type="DIFFUSE", use_clear=True)
    seen = numpy.array(image.pixels[:]).reshape(size, PARTS, size, PARTS, 4)[..., 0] > FRONTS
    whole = seen.all(axis=(1, 3))
    mask = bpy.data.images.new("mask", size, size, float_buffer=True, is_data=True)
    mask.pixels = numpy.repeat(whole.astype(float).ravel(), 4).tolist()
    save(mask, path)


def main(path, size, bounces, counts, seed, prefix):
    image = prepare(path, size)
    configure(bounces)
    for samples in counts:
        bpy.context.scene.cycles.samples = samples
        bpy.context.scene.cycles.seed = seed
        before, start = os.times(), time.perf_counter()
        bpy.ops.object.bake(type="DIFFUSE", use_clear=True)
        wall, after = time.perf_counter() - start, os.times()
        cpu = (after.user - before.user) + (after.system - before.system)
        save(image, "%s-%d.exr" % (prefix, samples))
        print("cycles %d %.3f %.3f" % (samples, cpu, wall), flush=True)
    save_mask(size, prefix + "-mask.exr")


arguments = sys.argv[sys.argv.index("--") + 1 :]
main(
    os.path.abspath(arguments[0]),
    int(arguments[1]),
    int(arguments[2]),
    [int(n) for n in arguments[3].split(",")],
    int(arguments[4]),
    os.path.abspath(arguments[5]),
)
