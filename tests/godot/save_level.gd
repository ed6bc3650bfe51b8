# Opens level.tscn in the editor, saves it as a user would, and ends.
@tool
extends EditorPlugin

const OPEN := 60 # frames after which the editor is there
const SAVE := 120
const END := 150

var _frames := 0


func _process(_seconds: float) -> void:
    _frames += 1
    if _frames == OPEN:
        EditorInterface.open_scene_from_path("res://level/level.tscn")
    elif _frames == SAVE:
        EditorInterface.mark_scene_as_unsaved()
        EditorInterface.save_scene()
        print("SAVED")
    elif _frames == END:
        var gi: LightmapGI = EditorInterface.get_edited_scene_root().get_node("LightmapGI")
        print("LIT" if gi.light_data != null else "DARK")
        get_tree().quit()
