# Lights scene.glb by lightmap.exr, which Relume baked (Godot 4.2 or newer).
#
# Copy the exported folder into a project and open level.tscn. In the import dock, lightmap.exr needs no settings: it is
# read as a picture here. Lightmap and emission are in cd/m^2; the environment's exposure brings them to the screen.
@tool
extends Node3D


func _ready() -> void:
    var folder := scene_file_path.get_base_dir()
    var image := _load_picture(folder.path_join("lightmap.exr"))
    if image.is_compressed():
        image.decompress()
    image.convert(Image.FORMAT_RGBAH)
    var texture := Texture2DArray.new()
    texture.create_from_images([image])
    var data := LightmapGIData.new()
    data.lightmap_textures = [texture]
    var gi: LightmapGI = $LightmapGI
    for mesh: MeshInstance3D in $Scene.find_children("*", "MeshInstance3D", true, false):
        if _has_lightmap_uvs(mesh.mesh):
            data.add_user(gi.get_path_to(mesh), Rect2(0, 0, 1, 1), 0, -1)
    gi.light_data = data


# What the lightmap does not light has no second set of UVs.
func _has_lightmap_uvs(mesh: Mesh) -> bool:
    for surface in mesh.get_surface_count():
        if mesh.surface_get_format(surface) & Mesh.ARRAY_FORMAT_TEX_UV2:
            return true
    return false


# An exported game has the picture as an imported texture, the editor has the file as well.
func _load_picture(path: String) -> Image:
    if ResourceLoader.exists(path):
        return (load(path) as Texture2D).get_image()
    return Image.load_from_file(path)
