# What the tests of the add-on share: what was heard, what was played on which bus, and how something is touched.
extends SceneTree

const Heard := preload("heard.gd")

var heard := Heard.new()
var passed := 0
var failed := 0
var captures := {}


func listen() -> void:
	OS.add_logger(heard)
	for bus in ["Sound", "Haptics"]:
		AudioServer.add_bus()
		var index := AudioServer.bus_count - 1
		AudioServer.set_bus_name(index, bus)
		captures[bus] = AudioEffectCapture.new()
		captures[bus].buffer_length = 8.0
		AudioServer.add_bus_effect(index, captures[bus])


func check(sentence: String, holds: bool, told = "") -> void:
	passed += int(holds)
	failed += int(not holds)
	print("%s %s%s" % ["ok  " if holds else "FAIL", sentence, " (%s)" % str(told) if str(told) else ""])


func made(scene_file := "", audio_bus := "Sound", haptic_bus := "Haptics") -> AsperityWorld:
	var world := AsperityWorld.new()
	world.scene_file = scene_file
	world.audio_bus = audio_bus
	world.haptic_bus = haptic_bus
	root.add_child(world)
	return world


# A world whose levels are what its numbers say: what is felt of two surfaces can be compared.
func as_given() -> AsperityWorld:
	var world := made("", "", "")
	world.levels = "as_given"
	world.gain = 0.2
	world.build()
	return world


func gone(world: Node) -> void:
	world.queue_free()
	for frame in 20:
		await physics_frame
	for bus in captures:
		captures[bus].clear_buffer()


func taken(bus: String) -> PackedVector2Array:
	return captures[bus].get_buffer(captures[bus].get_frames_available())


func rms(frames: PackedVector2Array, side: int) -> float:
	var sum := 0.0
	for frame in frames:
		sum += frame[side] * frame[side]
	return sqrt(sum / maxi(1, frames.size()))


# What is played comes so many frames late, and ends before a rendered tail.
func same_bits(played: PackedVector2Array, side: int, rendered: PackedFloat32Array, late: int) -> bool:
	var frames := played.size() - late
	for i in frames:
		if played[i + late][side] != rendered[i]:
			print("     frame %d of %d: %.9g, not %.9g" % [i, frames, played[i + late][side], rendered[i]])
			return false
	return frames > 44100 and frames <= rendered.size()


func stroke(world: AsperityWorld, surface: int, ticks: int, contact := 1, channel := 0) -> void:
	world.report_begin(contact, surface, Vector2(0.2, 0.5), 0.6, channel)
	for tick in ticks:
		await physics_frame
		world.report_move(contact, Vector2(0.2 + 0.3 * sin(tick / 40.0), 0.5), 0.6)
	world.report_end(contact)


func ridged(scale: float) -> StandardMaterial3D:
	var image := Image.create_empty(256, 256, false, Image.FORMAT_RGB8)
	for y in 256:
		for x in 256:
			image.set_pixel(x, y, Color.from_hsv(0, 0, 0.5 + 0.5 * sin(TAU * x / 16.0)))
	var material := StandardMaterial3D.new()
	material.heightmap_enabled = true
	material.heightmap_texture = ImageTexture.create_from_image(image)
	material.heightmap_scale = scale
	material.roughness = 0.0
	return material


func felt(material: StandardMaterial3D) -> float:
	return await felt_on(AsperitySurface.from_material(material, 0.2, 0.2))


# Mixed by the test, tick by tick: the level is the same under any load.
func felt_on(surface: AsperitySurface) -> float:
	var world := as_given()
	var sound := world.audio_stream().instantiate_playback()
	var touch := world.haptic_stream(0, -1).instantiate_playback()
	var frames := PackedVector2Array()
	var id := world.add_surface(surface, 0, "made")
	world.report_begin(1, id, Vector2(0.2, 0.5), 0.6, 0)
	for tick in 60:
		await physics_frame
		world.report_move(1, Vector2(0.2 + 0.3 * sin(tick / 40.0), 0.5), 0.6)
		sound.mix_audio(1.0, 735)
		frames.append_array(touch.mix_audio(1.0, 735))
	world.report_end(1)
	await gone(world)
	return rms(frames, 0)


# A table of 30 cm that a finger finds and the world rings, ridged where no material is given; the ground of tests.
func table(material: StandardMaterial3D = null) -> StaticBody3D:
	var drawn := MeshInstance3D.new()
	drawn.mesh = PlaneMesh.new()
	drawn.mesh.size = Vector2(0.3, 0.3)
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	shape.shape.size = Vector3(0.3, 0.02, 0.3)
	shape.position.y = -0.01
	var body := AsperityBody.new()
	body.name = "Table"
	body.surface = AsperitySurface.from_material(material if material else ridged(0.1), 0.3, 0.3)
	var collider := StaticBody3D.new()
	for child in [drawn, shape, body]:
		collider.add_child(child)
	root.add_child(collider)
	return collider


func finger_above() -> AsperityFinger3D:
	var finger := AsperityFinger3D.new()
	finger.position.y = 0.05
	root.add_child(finger)
	return finger
