# Drag over the plate: it sounds as it looks. Space knocks on it. A ridged steel plate, whose heightmap the renderer draws and the finger feels.
extends Node3D

const SIZE_M := 0.3

@onready var world: AsperityWorld = $World
var plate: AsperityBody
var finger: AsperityFinger3D
var camera: Camera3D


func _ready() -> void:
	camera = Camera3D.new()
	add_child(camera)
	camera.look_at_from_position(Vector3(0, 0.35, 0.2), Vector3.ZERO)
	var light := DirectionalLight3D.new()
	light.rotation_degrees = Vector3(-50, 40, 0)
	add_child(light)
	add_child(_plate())
	finger = AsperityFinger3D.new()
	finger.force_n = 0.8
	finger.position.y = 0.02
	finger.pressing = false
	var tip := MeshInstance3D.new()
	tip.mesh = SphereMesh.new()
	tip.mesh.radius = 0.008
	tip.mesh.height = 0.016
	finger.add_child(tip)
	add_child(finger)
	if DisplayServer.get_name() == "headless":
		_stroke_and_quit()


func _plate() -> StaticBody3D:
	var material := StandardMaterial3D.new()
	material.heightmap_enabled = true
	material.heightmap_texture = _ridges()
	material.heightmap_scale = 0.1
	material.roughness = 0.4
	material.metallic = 0.7
	var drawn := MeshInstance3D.new()
	drawn.mesh = PlaneMesh.new()
	drawn.mesh.size = Vector2(SIZE_M, SIZE_M)
	drawn.material_override = material
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	shape.shape.size = Vector3(SIZE_M, 0.01, SIZE_M)
	shape.position.y = -0.005
	plate = AsperityBody.new()
	plate.name = "Plate"
	plate.surface = AsperitySurface.from_material(material, SIZE_M, SIZE_M)
	var body := StaticBody3D.new()
	for child in [drawn, shape, plate]:
		body.add_child(child)
	return body


func _ridges() -> ImageTexture:
	var image := Image.create_empty(256, 256, false, Image.FORMAT_L8)
	for y in 256:
		for x in 256:
			image.set_pixel(x, y, Color.from_hsv(0, 0, 0.5 + 0.5 * sin(TAU * x / 8.0) * sin(TAU * y / 64.0)))
	return ImageTexture.create_from_image(image)


func _unhandled_input(event: InputEvent) -> void:
	if event is InputEventMouseButton:
		finger.pressing = event.pressed
	if event is InputEventMouse:
		var from := camera.project_ray_origin(event.position)
		var along := camera.project_ray_normal(event.position)
		var at = Plane(Vector3.UP).intersects_ray(from, along)
		if at != null:
			finger.position = at + Vector3(0, 0.02, 0)
	if event.is_action_pressed("ui_select"):
		world.report_impact(plate.body_id(), 1.0, 0.02, 0.005, "wood", 0)


# Without a window the finger strokes by itself for two seconds.
func _stroke_and_quit() -> void:
	finger.pressing = true
	for tick in 120:
		finger.position.x = 0.12 * sin(tick / 20.0)
		await get_tree().physics_frame
	print("touching: ", finger.is_touching(), "  ", world.stats())
	get_tree().quit()
