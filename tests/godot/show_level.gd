# Draws an exported level, without tone mapping, as a given camera sees it: --script show_level.gd -- LEVEL PICTURE
# EYE TARGET FOV, the points as x,y,z [m] and the angle of the picture's height in degrees.
extends SceneTree

const FRAMES := 8 # shaders are there by then

var _frames := 0
var _picture := ""


func _initialize() -> void:
    var words := OS.get_cmdline_user_args()
    var level: Node3D = load(words[0]).instantiate()
    level.get_node("WorldEnvironment").environment.tonemap_mode = Environment.TONE_MAPPER_LINEAR
    root.add_child(level)
    var camera := Camera3D.new()
    camera.fov = float(words[4])
    camera.near = 0.01
    root.add_child(camera)
    camera.look_at_from_position(_point(words[2]), _point(words[3]))
    camera.make_current()
    _picture = words[1]


func _process(_seconds: float) -> bool:
    _frames += 1
    if _frames < FRAMES:
        return false
    root.get_texture().get_image().save_png(_picture)
    return true


func _point(words: String) -> Vector3:
    var numbers := words.split_floats(",")
    return Vector3(numbers[0], numbers[1], numbers[2])
