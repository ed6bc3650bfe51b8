"""Bakes a scene's lightmap with Blender's Cycles on the CPU and says what it cost.

blender -b --factory-startup -P cycles_bake.py -- SCENE.glb SIZE BOUNCES SAMPLES,... SEED OUT_PREFIX

Writes OUT_PREFIX-SAMPLES.exr (lighting = irradiance / pi, as relume's; row 0 is v = 0) and a line per bake on standard
output: "cycles SAMPLES CPU_SECONDS WALL_SECONDS". CPU seconds are this process's user and system time during the bake
itself, its scene synchronisation and BVH included, Blender's start and the import of the scene excluded.

OUT_PREFIX-mask.exr is 1 in texels that the last bake lit and that have no dark one beside them: at the edge of a chart or
of something that stands on it Cycles takes the mean over the texel, relume the light at the nearest place it can see, and
no number of samples makes these equal.
"""

import os
import sys
import time

import bpy
import numpy

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Debian 12's Blender imports glTF by a name that its numpy no longer has


def diffuse(material):
    """Rebuilds an imported material as Lambert's reflection plus one-sided emission: relume's model."""
    principled = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    colour = tuple(principled.inputs["Base Color"].default_value)
    emission = tuple(principled.inputs["Emission"].default_value)
    strength = principled.inputs["Emission Strength"].default_value
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    reflection = nodes.new("ShaderNodeBsdfDiffuse")
    reflection.inputs["Color"].default_value = colour
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
    links.new(shader, output.inputs["Surface"])
    return max(emission[:3]) * strength


def shape_lamps():
    """Gives lamps the radius that relume's extras say; the importer makes points of them."""
    for light in bpy.data.lights:
        own = light.get("relume")
        if own is not None and "radius" in own:
            light.shadow_soft_size = own["radius"]


def prepare(path, size):
    """Imports the scene as one object; returns the image all its materials bake into."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.import_scene.gltf(filepath=path)
    meshes = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    materials = {slot.material for mesh in meshes for slot in mesh.material_slots}
    brightest = max(diffuse(material) for material in materials)
    print("cycles_bake: %d meshes, %d materials, brightest emission %g" % (len(meshes), len(materials), brightest))
    shape_lamps()
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


def save_mask(image, path):
    width, height = image.size
    lit = numpy.array(image.pixels[:]).reshape(height, width, 4)[:, :, :3].sum(axis=2) > 0
    for axis in (0, 1):  # a square of 3 x 3; what is beyond the image counts as dark
        padded = numpy.pad(lit, [(1, 1) if a == axis else (0, 0) for a in (0, 1)])
        count = lit.shape[axis]
        lit = numpy.logical_and.reduce([padded.take(range(k, k + count), axis) for k in range(3)])
    mask = bpy.data.images.new("mask", width, height, float_buffer=True, is_data=True)
    mask.pixels = numpy.repeat(lit.astype(float).ravel(), 4).tolist()
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
    save_mask(image, prefix + "-mask.exr")


arguments = sys.argv[sys.argv.index("--") + 1 :]
main(
    os.path.abspath(arguments[0]),
    int(arguments[1]),
    int(arguments[2]),
    [int(n) for n in arguments[3].split(",")],
    int(arguments[4]),
    os.path.abspath(arguments[5]),
)
