@ONE@# Lights scene.glb by lightmap.exr, which Relume baked (Godot 4.2 or newer).
@MANY@# Lights scene.glb by lightmap.0.exr and so on, which Relume baked (Godot 4.2 or newer).
#
@ONE@# Copy the exported folder into a project and open level.tscn. In the import dock, lightmap.exr needs no settings: it is
@ONE@# read as a picture here. Lightmap and emission are in cd/m^2; the environment's exposure brings them to the screen.
@MANY@# Copy the exported folder into a project and open level.tscn. In the import dock, the pages of the lightmap need no
@MANY@# settings: they are read as pictures here. Lightmap and emission are in cd/m^2; the environment's exposure brings them
@MANY@# to the screen.
@tool
extends Node3D

@MANY@# The pages that light materials, by their names.
@MANY@const PAGES := {
@MANY@@EACH@    "@MATERIAL@": @PAGE@,
@MANY@}


func _ready() -> void:
    var folder := scene_file_path.get_base_dir()
@ONE@    var pages: Array[Image] = [_load_picture(folder.path_join("lightmap.exr"))]
@MANY@    var pages: Array[Image] = []
@MANY@    for page in @PAGES@:
@MANY@        pages.append(_load_picture(folder.path_join("lightmap.%d.exr" % page)))
    var texture := Texture2DArray.new()
    texture.create_from_images(pages)
    var data := LightmapGIData.new()
    data.lightmap_textures = [texture]
    var gi: LightmapGI = $LightmapGI
    for mesh: MeshInstance3D in $Scene.find_children("*", "MeshInstance3D", true, false):
        if _has_lightmap_uvs(mesh.mesh):
@ONE@            data.add_user(gi.get_path_to(mesh), Rect2(0, 0, 1, 1), 0, -1)
@MANY@            data.add_user(gi.get_path_to(mesh), Rect2(0, 0, 1, 1), _page_of(mesh.mesh), -1)
    gi.light_data = data


# What the lightmap does not light has no second set of UVs.
func _has_lightmap_uvs(mesh: Mesh) -> bool:
    for surface in mesh.get_surface_count():
        if mesh.surface_get_format(surface) & Mesh.ARRAY_FORMAT_TEX_UV2:
            return true
    return false


@MANY@# All that the lightmap lights of an object is on one page.
@MANY@func _page_of(mesh: Mesh) -> int:
@MANY@    for surface in mesh.get_surface_count():
@MANY@        var material := mesh.surface_get_material(surface)
@MANY@        if material != null and PAGES.has(material.resource_name):
@MANY@            return PAGES[material.resource_name]
@MANY@    return 0
@MANY@
@MANY@
# An exported game has a picture as an imported texture, the editor has the file as well.
func _load_picture(path: String) -> Image:
    var image: Image = null
    if ResourceLoader.exists(path):
        image = (load(path) as Texture2D).get_image()
    else:
        image = Image.load_from_file(path)
    if image.is_compressed():
        image.decompress()
    image.convert(Image.FORMAT_RGBAH)
    return image
