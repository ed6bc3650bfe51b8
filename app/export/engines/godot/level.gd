@ONE@# Lights scene.glb by lightmap.exr, which Relume baked (Godot 4.2 or newer).
@MANY@# Lights scene.glb by lightmap.0.exr and so on, which Relume baked (Godot 4.2 or newer).
#
@ONE@# Copy the exported folder into a project and open level.tscn. In the import dock, lightmap.exr needs no settings: it is
@ONE@# read as a picture here. The lightmap is in cd/m^2; EXPOSURE brings it to the screen, where 1 is white. The level's
@ONE@# emission is there already, and so light beside the level's needs no other energy than it has in any project.
@MANY@# Copy the exported folder into a project and open level.tscn. In the import dock, the pages of the lightmap need no
@MANY@# settings: they are read as pictures here. The lightmap is in cd/m^2; EXPOSURE brings it to the screen, where 1 is
@MANY@# white. The level's emission is there already, and so light beside the level's needs no other energy than it has in
@MANY@# any project.
@tool
extends Node3D

const EXPOSURE := @FACTOR@

@MANY@# The pages that light materials, by their names.
@MANY@const PAGES := {
@MANY@@EACH@    "@MATERIAL@": @PAGE@,
@MANY@}

var _light: LightmapGIData


func _ready() -> void:
    var folder := scene_file_path.get_base_dir()
@ONE@    var pages: Array[Image] = [_load_light(folder.path_join("lightmap.exr"))]
@MANY@    var pages: Array[Image] = []
@MANY@    for page in @PAGES@:
@MANY@        pages.append(_load_light(folder.path_join("lightmap.%d.exr" % page)))
    var texture := Texture2DArray.new()
    texture.create_from_images(pages)
    _light = LightmapGIData.new()
    _light.lightmap_textures = [texture]
    for mesh: MeshInstance3D in $Scene.find_children("*", "MeshInstance3D", true, false):
        _sharpen(mesh.mesh)
        if _has_lightmap_uvs(mesh.mesh):
@ONE@            _light.add_user($LightmapGI.get_path_to(mesh), Rect2(0, 0, 1, 1), 0, -1)
@MANY@            _light.add_user($LightmapGI.get_path_to(mesh), Rect2(0, 0, 1, 1), _page_of(mesh.mesh), -1)
    $LightmapGI.light_data = _light


# The editor would write the whole lightmap into level.tscn.
func _notification(what: int) -> void:
    if what == NOTIFICATION_EDITOR_PRE_SAVE:
        $LightmapGI.light_data = null
    elif what == NOTIFICATION_EDITOR_POST_SAVE:
        $LightmapGI.light_data = _light


# Textures stay sharp where they are seen at a flat angle.
func _sharpen(mesh: Mesh) -> void:
    for surface in mesh.get_surface_count():
        var material := mesh.surface_get_material(surface) as BaseMaterial3D
        if material != null and material.texture_filter == BaseMaterial3D.TEXTURE_FILTER_LINEAR_WITH_MIPMAPS:
            material.texture_filter = BaseMaterial3D.TEXTURE_FILTER_LINEAR_WITH_MIPMAPS_ANISOTROPIC


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
# An exported game has a picture as an imported texture, the editor has the file as well. The mobile renderer shows no
# light above 2, so that exposure comes first and not with the environment's tone mapping.
func _load_light(path: String) -> Image:
    var image: Image = null
    if ResourceLoader.exists(path):
        image = (load(path) as Texture2D).get_image()
    else:
        image = Image.load_from_file(path)
    if image.is_compressed():
        image.decompress()
    image.convert(Image.FORMAT_RGBF)
    image.adjust_bcs(EXPOSURE, 1.0, 1.0)
    image.convert(Image.FORMAT_RGBAH)
    return image
