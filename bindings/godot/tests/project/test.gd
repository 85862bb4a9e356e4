# The add-on in a real Godot: `godot --headless --path . --script test.gd`. Ends with a summary line, and code 1 where something failed.
extends SceneTree

const Heard := preload("heard.gd")

var heard := Heard.new()
var passed := 0
var failed := 0
var captures := {}


func _initialize() -> void:
	OS.add_logger(heard)
	for bus in ["Sound", "Haptics"]:
		AudioServer.add_bus()
		var index := AudioServer.bus_count - 1
		AudioServer.set_bus_name(index, bus)
		captures[bus] = AudioEffectCapture.new()
		captures[bus].buffer_length = 8.0
		AudioServer.add_bus_effect(index, captures[bus])
	await process_frame
	await a_missing_scene_file_says_so()
	await a_stroke_of_three_seconds_sounds_and_is_felt()
	await what_was_played_is_recorded_and_renders()
	await a_second_playback_is_silent_and_says_why()
	await a_player_that_stops_can_play_again()
	await stale_ids_are_refused()
	await what_is_refused_says_what_would_be_right()
	await a_materials_heightmap_is_felt()
	await a_normal_map_is_felt()
	await a_normal_map_gives_the_heights_that_it_was_made_of()
	a_normal_map_that_is_none_says_why_it_is_not_felt()
	await a_finger_feels_the_mesh_under_it()
	await what_a_material_repeats_is_felt_repeated()
	await what_rolls_is_softer_than_what_slides()
	await a_strike_gain_turns_blows_down()
	await a_blow_that_is_felt_stays_within_full_scale()
	await a_world_that_is_built_again_takes_everything_along()
	await a_scene_is_freed_while_it_plays()
	OS.remove_logger(heard)
	print("%d passed, %d failed" % [passed, failed])
	quit(1 if failed else 0)


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


func a_missing_scene_file_says_so() -> void:
	var world := made("res://nowhere.toml")
	check("a missing scene file says so", "nowhere.toml" in world.last_error() and heard.has("nowhere.toml"), world.last_error())
	check("a world that is not built refuses reports", not world.report_end(1) and "not built" in world.last_error())
	check("a world that is not built has no stream", world.audio_stream() == null)
	world.scene_file = "res://plate.toml"
	check("it can be built afterwards", world.build(), world.last_error())
	await gone(world)


func a_stroke_of_three_seconds_sounds_and_is_felt() -> void:
	var world := made("res://plate.toml")
	var plate := world.find_surface("plate")
	check("a scene file's names are known", plate != 0 and world.find_body("plate") != 0 and world.find_body("bell") == 0)
	for tick in 10:
		await physics_frame
	world.report_begin(2, plate, Vector2(0.3, 0.3), 0.4, 1)
	world.report_begin(1, plate, Vector2(0.2, 0.5), 0.6, 0)
	var steady := true
	for tick in 180:
		await physics_frame
		steady = world.report_move(1, Vector2(0.2 + 0.003 * tick, 0.5), 0.6) and steady
		steady = world.report_move(2, Vector2(0.3, 0.3 + 0.002 * tick), 0.4) and steady
		if tick == 90:
			steady = world.report_impact(world.find_body("plate"), 0.5, 0.01, 0.005, "wood", 0) and steady
	world.report_end(1)
	world.report_end(2)
	for tick in 30:
		await physics_frame
	var sound := taken("Sound")
	var touch := taken("Haptics")
	var stats := world.stats()
	check("every report of 180 ticks is taken", steady and stats.refused == 0, world.last_error())
	check("a stroke of three seconds sounds", rms(sound, 0) > 1e-4, "rms %.5f, %d frames" % [rms(sound, 0), sound.size()])
	check("two haptic channels vibrate", rms(touch, 0) > 1e-4 and rms(touch, 1) > 1e-4, "rms %.5f and %.5f" % [rms(touch, 0), rms(touch, 1)])
	check("they are not the same", rms(touch, 0) != rms(touch, 1))
	check("the clock never jumps", stats.clock_jumps == 0, stats)
	await gone(world)


# The audio server's part is played by the test, a sixtieth of a second after each tick: no report comes late, as it may with another thread.
func what_was_played_is_recorded_and_renders() -> void:
	var world := made("res://plate.toml", "", "")
	var plate := world.find_surface("plate")
	var sound := world.audio_stream().instantiate_playback()
	var touch := world.haptic_stream(0, 1).instantiate_playback()
	var heard_frames := PackedVector2Array()
	var felt_frames := PackedVector2Array()
	world.record_start()
	for tick in 200:
		await physics_frame
		if tick == 10:
			world.report_begin(1, plate, Vector2(0.2, 0.5), 0.6, 0)
			world.report_begin(2, plate, Vector2(0.3, 0.3), 0.4, 1)
		elif tick > 10 and tick < 180:
			world.report_move(1, Vector2(0.2 + 0.003 * tick, 0.5), 0.6)
			world.report_move_at(2, Vector2(0.3, 0.3 + 0.002 * tick), 0.4, Vector2(0, 0.036))
		elif tick == 180:
			world.report_end(1)
			world.report_end(2)
		if tick == 90:
			world.report_impact(world.find_body("plate"), 0.5, 0.01, 0.005, "wood", 0)
		# From the first report on the game leads by a sixth of a tick: a stamp that lies on the very next sample is late by rounding.
		var frames := 612 if tick == 10 else 735
		heard_frames.append_array(sound.mix_audio(1.0, frames))
		felt_frames.append_array(touch.mix_audio(1.0, frames))
	check("nothing comes late", world.stats().late == 0 and world.stats().refused == 0, world.stats())
	check("a recording is written", world.record_stop("user://stroke.jsonl"), world.last_error())
	var render := world.render_log("user://stroke.jsonl")
	var audio: Array = render.get("audio", [])
	var haptic: Array = render.get("haptic", [])
	check("it renders", audio.size() == 1 and haptic.size() == 2, world.last_error())
	if audio.size() == 1 and haptic.size() == 2:
		for channel in 3:
			var played := heard_frames if channel == 0 else felt_frames
			var rendered: PackedFloat32Array = audio[0] if channel == 0 else haptic[channel - 1]
			check("channel %d plays what its recording renders, to the bit" % channel, same_bits(played, maxi(0, channel - 1), rendered, world.latency_frames()) and rms(played, maxi(0, channel - 1)) > 1e-4)
	await gone(world)


func a_second_playback_is_silent_and_says_why() -> void:
	var world := made("res://plate.toml", "Sound", "")
	var second := AudioStreamPlayer.new()
	second.stream = world.audio_stream()
	second.bus = "Haptics"
	root.add_child(second)
	second.play()
	check("a second playback says why it is silent", heard.has("is played already"))
	await stroke(world, world.find_surface("plate"), 40)
	check("a second playback is silent", rms(taken("Haptics"), 0) == 0.0)
	check("the first one sounds", rms(taken("Sound"), 0) > 1e-4)
	second.queue_free()
	await gone(world)


func a_player_that_stops_can_play_again() -> void:
	var world := made("res://plate.toml", "")
	var player := AudioStreamPlayer.new()
	player.stream = world.audio_stream()
	player.bus = "Sound"
	root.add_child(player)
	player.play()
	await stroke(world, world.find_surface("plate"), 20)
	player.stop()
	for frame in 30:
		await physics_frame
	taken("Sound")
	player.play()
	await stroke(world, world.find_surface("plate"), 40, 7)
	check("a player that stops can play again", rms(taken("Sound"), 0) > 1e-4)
	player.queue_free()
	await gone(world)


func stale_ids_are_refused() -> void:
	var world := made("")
	var surface := AsperitySurface.new()
	var first := world.add_surface(surface, 0, "first")
	check("a surface can be added and found", first != 0 and world.find_surface("first") == first)
	check("a surface can be removed", world.remove_surface(first) and world.find_surface("first") == 0)
	check("it cannot be removed twice", not world.remove_surface(first), world.last_error())
	var second := world.add_surface(surface, 0, "second")
	check("its place has another id", second != 0 and second != first)
	check("a stale id is refused", not world.report_begin(1, first, Vector2.ZERO, 0.5, 0), world.last_error())
	check("ids that never were are refused", not world.report_begin(1, -1, Vector2.ZERO, 0.5, 0) and not world.report_impact(12345, 1, 0.01, 0.005, "", 0))
	await gone(world)


func what_is_refused_says_what_would_be_right() -> void:
	var world := made("")
	var surface := AsperitySurface.new()
	var id := world.add_surface(surface, 0, "plain")
	check("a number that is none is refused", not world.report_begin(1, id, Vector2(NAN, 0), 0.5, 0), world.last_error())
	check("a force that is infinite is refused", not world.report_begin(1, id, Vector2.ZERO, INF, 0), world.last_error())
	check("a negative contact is refused", not world.report_begin(-4, id, Vector2.ZERO, 0.5, 0) and "must be" in world.last_error())
	check("an unknown striker is refused by name", not world.report_impact(0, 1, 0.01, 0.005, "cheese", 0) and "steel" in world.last_error(), world.last_error())
	check("a channel that is none is refused", world.haptic_stream(0, 7) == null, world.last_error())
	surface.width_m = -1.0
	check("a surface of negative width is refused", world.add_surface(surface, 0, "") == 0 and "width_m" in world.last_error(), world.last_error())
	surface.width_m = 1.0
	surface.table = "colour = 3"
	check("an unknown key is refused", world.add_surface(surface, 0, "") == 0 and "colour" in world.last_error(), world.last_error())
	check("no surface is refused", world.add_surface(null, 0, "") == 0)
	check("no material is refused", AsperitySurface.from_material(null, 1, 1) == null)
	check("a log that is missing says so", world.render_log("user://none.jsonl").is_empty() and "none.jsonl" in world.last_error(), world.last_error())
	var body := AsperityBody.new()
	body.stock = "potato"
	world.add_child(body)
	check("an unknown shape is refused", body.body_id() == 0 and "potato" in world.last_error(), world.last_error())
	await gone(world)


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
	var world := made("", "", "")
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


func a_materials_heightmap_is_felt() -> void:
	# As smooth as the others, without a heightmap.
	var smooth := StandardMaterial3D.new()
	smooth.roughness = 0.0
	var flat: float = await felt(smooth)
	var low: float = await felt(ridged(0.05))
	var high: float = await felt(ridged(0.2))
	check("a material's heightmap is felt", high > 2.0 * flat, "rms %.6f beside %.6f" % [high, flat])
	check("a higher one is felt more", high > 1.5 * low, "rms %.6f beside %.6f" % [high, low])


# Waves of 1 mm from crest to trough, 8 to the surface's 0.2 m, as normals; `format`: how an importer keeps them.
func normals_of_waves(format: Image.Format) -> StandardMaterial3D:
	const TEXELS := 256
	const WAVES := 8
	var steepest := 0.0005 * TAU * WAVES / 0.2
	var image := Image.create_empty(TEXELS, TEXELS, false, Image.FORMAT_RGB8)
	for y in TEXELS:
		for x in TEXELS:
			# Heights rise along u as a sine; green points up the picture.
			var normal := Vector3(-steepest * cos(TAU * WAVES * x / TEXELS), 0, 1).normalized()
			image.set_pixel(x, y, Color(0.5 + 0.5 * normal.x, 0.5 + 0.5 * normal.y, 0.5 + 0.5 * normal.z))
	image.convert(format)
	var material := StandardMaterial3D.new()
	material.normal_enabled = true
	material.normal_texture = ImageTexture.create_from_image(image)
	material.roughness = 0.0
	return material


func a_normal_map_is_felt() -> void:
	var smooth := StandardMaterial3D.new()
	smooth.roughness = 0.0
	var flat: float = await felt(smooth)
	var full: float = await felt(normals_of_waves(Image.FORMAT_RGB8))
	# The same waves as a heightmap.
	var image := Image.create_empty(256, 256, false, Image.FORMAT_RF)
	for y in 256:
		for x in 256:
			image.set_pixel(x, y, Color(0.5 + 0.5 * sin(TAU * 8 * x / 256.0), 0, 0))
	var heights := AsperitySurface.from_material(smooth, 0.2, 0.2)
	heights.displacement = ImageTexture.create_from_image(image)
	heights.relief_m = 0.001
	var told: float = await felt_on(heights)
	check("a material that has only a normal map is felt by it", full > 1.5 * flat, "rms %.6f beside %.6f" % [full, flat])
	check("as its heights as a heightmap are felt", absf(full / told - 1.0) < 0.05, "rms %.6f beside %.6f" % [full, told])
	var off := normals_of_waves(Image.FORMAT_RGB8)
	off.normal_enabled = false
	check("one that does not draw its normal map is not", AsperitySurface.from_material(off, 0.2, 0.2).displacement == null)


func a_normal_map_gives_the_heights_that_it_was_made_of() -> void:
	for format in [Image.FORMAT_RGB8, Image.FORMAT_RGBA8, Image.FORMAT_RG8, Image.FORMAT_RGBAF]:
		var surface := AsperitySurface.from_material(normals_of_waves(format), 0.2, 0.2)
		var relief_mm := 1000.0 * surface.relief_m
		check("normals of waves of 1 mm have a relief of 1 mm, format %d" % format, absf(relief_mm - 1.0) < 0.02, "%.4f mm" % relief_mm)
		var heights := surface.displacement.get_image()
		var worst := 0.0
		for x in heights.get_width():
			worst = maxf(worst, absf(heights.get_pixel(x, 100).r - (0.5 + 0.5 * sin(TAU * 8 * x / heights.get_width()))))
		check("and the shape of the waves, white is high", worst < 0.02, "%.4f of the relief" % worst)
	var half := normals_of_waves(Image.FORMAT_RGB8)
	half.normal_scale = 0.5
	var halved := 1000.0 * AsperitySurface.from_material(half, 0.2, 0.2).relief_m
	check("a normal scale of a half halves them", absf(halved - 0.5) < 0.01, "%.4f mm" % halved)
	half.normal_scale = -0.5
	var turned := AsperitySurface.from_material(half, 0.2, 0.2).displacement.get_image()
	check("and a negative one turns them over", turned.get_pixel(8, 100).r < 0.1 and turned.get_pixel(24, 100).r > 0.9)
	half.normal_scale = 1.0
	half.uv1_scale = Vector3(4, 4, 1)
	var repeated := AsperitySurface.from_material(half, 0.8, 0.8)
	check("repeated four times on four times the length they are as high", absf(1000.0 * repeated.relief_m - 1.0) < 0.02, "%.4f mm" % (1000.0 * repeated.relief_m))
	half.uv1_scale = Vector3(0, 4, 1)
	var world := made("")
	check("repeated not at all is refused", world.add_surface(AsperitySurface.from_material(half, 1, 1), 0, "") == 0 and "uv_scale" in world.last_error(), world.last_error())
	await gone(world)


func a_normal_map_that_is_none_says_why_it_is_not_felt() -> void:
	var image := Image.create_empty(64, 64, false, Image.FORMAT_RGB8)
	for y in 64:
		for x in 64:
			image.set_pixel(x, y, Color.from_hsv(0.08, 0.7, 0.2 + 0.5 * ((7 * x + 3 * y) % 5) / 5.0))
	var material := StandardMaterial3D.new()
	material.normal_enabled = true
	material.normal_texture = ImageTexture.create_from_image(image)
	var surface := AsperitySurface.from_material(material, 0.2, 0.2)
	check("a photograph instead of a normal map is not felt, and says why", surface.displacement == null and heard.has("photograph"))


# A ridged table of 30 cm that a finger finds and the world rings; the ground of tests.
func table() -> StaticBody3D:
	var drawn := MeshInstance3D.new()
	drawn.mesh = PlaneMesh.new()
	drawn.mesh.size = Vector2(0.3, 0.3)
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	shape.shape.size = Vector3(0.3, 0.02, 0.3)
	shape.position.y = -0.01
	var body := AsperityBody.new()
	body.name = "Table"
	body.surface = AsperitySurface.from_material(ridged(0.1), 0.3, 0.3)
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


func a_finger_feels_the_mesh_under_it() -> void:
	var world := made("")
	var collider := table()
	var body: AsperityBody = collider.get_node("Table")
	var finger := finger_above()
	for tick in 60:
		finger.position.x = -0.1 + 0.003 * tick
		await physics_frame
	check("a finger touches the mesh under it", finger.is_touching(), world.last_error())
	check("it is felt", rms(taken("Haptics"), 0) > 1e-4)
	check("the body rings", rms(taken("Sound"), 0) > 1e-6)
	finger.position.y = 1.0
	await physics_frame
	await physics_frame
	check("a finger that is lifted touches nothing", not finger.is_touching())
	var old := body.body_id()
	root.remove_child(collider)
	check("a body that leaves the tree is unknown", world.find_body("Table") == 0 and not world.report_impact(old, 1, 0.01, 0.005, "", 0))
	root.add_child(collider)
	check("it joins again with the tree", body.body_id() != 0 and body.body_id() != old)
	check("and rings when it is struck", world.report_impact(body.body_id(), 1, 0.01, 0.005, "steel", 0), world.last_error())
	finger.position.y = 0.05
	for tick in 3:
		await physics_frame
	check("a finger that comes back touches it again", finger.is_touching(), world.last_error())
	world.free()
	for tick in 3:
		await physics_frame
	check("a finger and a body whose world is freed are in none", not finger.is_touching() and body.body_id() == 0 and body.surface_id() == 0)
	var next := made("")
	root.remove_child(collider)
	root.add_child(collider)
	for tick in 3:
		await physics_frame
	check("and join the next one", finger.is_touching() and next.find_body("Table") == body.body_id() and body.body_id() != 0, next.last_error())
	collider.queue_free()
	finger.queue_free()
	await gone(next)


# What a finger reports of a plate whose material repeats its maps, from the recording.
func what_a_material_repeats_is_felt_repeated() -> void:
	var spans := []
	for repeats in [1, 4]:
		var world := made("")
		var material := ridged(0.02)
		material.uv1_scale = Vector3(repeats, repeats, 1)
		material.uv1_offset = Vector3(0.25, 0, 0)
		var drawn := MeshInstance3D.new()
		drawn.mesh = PlaneMesh.new()
		drawn.mesh.size = Vector2(0.3, 0.3)
		var shape := CollisionShape3D.new()
		shape.shape = BoxShape3D.new()
		shape.shape.size = Vector3(0.3, 0.02, 0.3)
		shape.position.y = -0.01
		var body := AsperityBody.new()
		body.surface = AsperitySurface.from_material(material, 0.3, 0.3)
		var collider := StaticBody3D.new()
		for child in [drawn, shape, body]:
			collider.add_child(child)
		root.add_child(collider)
		var finger := AsperityFinger3D.new()
		finger.position = Vector3(-0.12, 0.05, 0)
		root.add_child(finger)
		world.record_start()
		for tick in 60:
			finger.position.x = -0.12 + 0.004 * tick
			await physics_frame
		world.record_stop("user://repeated.jsonl")
		var us := []
		for line in FileAccess.get_file_as_string("user://repeated.jsonl").split("\n", false):
			var event = JSON.parse_string(line)
			if event.has("uv"):
				us.append(event.uv[0])
		spans.append(us.max() - us.min() if us else 0.0)
		if us:
			check("its offset counts, repeated %d times" % repeats, absf(us.min() - (0.1 * repeats + 0.25)) < 0.02 * repeats, us.min())
		collider.queue_free()
		finger.queue_free()
		await gone(world)
	check("what a material repeats four times is met four times as often", spans[0] > 0.5 and absf(spans[1] / maxf(spans[0], 1e-9) - 4.0) < 0.4, spans)


# The same motion on the same plate, mixed by the test.
func heard_rolling(slip_m_s: float) -> float:
	var world := made("res://plate.toml", "", "")
	var sound := world.audio_stream().instantiate_playback()
	var frames := PackedVector2Array()
	var plate := world.find_surface("plate")
	for tick in 60:
		var uv := Vector2(0.2 + 0.01 * tick, 0.5)
		if tick == 0 and is_nan(slip_m_s):
			world.report_begin(1, plate, uv, 0.6, 0)
		elif tick == 0:
			world.report_begin(1, plate, uv, 0.6, 0, slip_m_s, 0.01)
		elif is_nan(slip_m_s):
			world.report_move(1, uv, 0.6)
		else:
			world.report_move(1, uv, 0.6, slip_m_s, 0.01)
		await physics_frame
		frames.append_array(sound.mix_audio(1.0, 735))
	check("rolling is taken", world.stats().refused == 0 and world.stats().contacts == 1, world.last_error())
	check("a slip that cannot be is refused by name", not world.report_move(1, Vector2.ZERO, 0.6, -1.0) and "slip_m_s" in world.last_error(), world.last_error())
	await gone(world)
	return rms(frames, 0)


func what_rolls_is_softer_than_what_slides() -> void:
	var slides: float = await heard_rolling(NAN)
	var rolls: float = await heard_rolling(0.0)
	check("what rolls is softer than what slides", rolls > 1e-6 and rolls < 0.7 * slides, "rms %.6f beside %.6f" % [rolls, slides])


func a_strike_gain_turns_blows_down() -> void:
	var peaks := []
	for strike_gain in [-1.0, 0.25]:
		var world := made("", "", "")
		var sound := world.audio_stream().instantiate_playback()
		var body := AsperityBody.new()
		body.gain = 0.005
		body.strike_gain = strike_gain
		world.add_child(body)
		world.report_impact(body.body_id(), 0.5, 0.01, 0.005, "steel", -1)
		var peak := 0.0
		for tick in 10:
			await physics_frame
			for frame in sound.mix_audio(1.0, 735):
				peak = maxf(peak, absf(frame.x))
		check("no limiter works", world.stats().limiter_db == 0, world.stats())
		peaks.append(peak)
		await gone(world)
	check("a strike gain of a quarter makes a blow a quarter as loud", peaks[0] > 1e-6 and absf(peaks[1] / peaks[0] - 0.25) < 0.01, peaks)


# Without a scene file nobody has set levels: strokes are within full scale by themselves, blows by limiters.
func a_blow_that_is_felt_stays_within_full_scale() -> void:
	var world := made("", "", "")
	var sound := world.audio_stream().instantiate_playback()
	var touch := world.haptic_stream(0, 1).instantiate_playback()
	var body := AsperityBody.new()
	body.surface = AsperitySurface.from_material(ridged(0.1), 0.3, 0.3)
	world.add_child(body)
	var peaks := [0.0, 0.0]
	for tick in 90:
		var uv := Vector2(0.2 + 0.01 * tick, 0.5)
		if tick == 0:
			world.report_begin(1, body.surface_id(), uv, 0.8, 0)
		elif tick < 60:
			world.report_move(1, uv, 0.8)
		elif tick == 60:
			check("a stroke keeps within full scale without its limiters", world.stats().limiter_db == 0 and peaks[0] > 0.005 and peaks[1] > 0.02, [peaks, world.stats()])
			world.report_end(1)
			world.report_impact(body.body_id(), 1.0, 0.02, 0.005, "wood", 0)
		await physics_frame
		for frame in sound.mix_audio(1.0, 735):
			peaks[0] = maxf(peaks[0], absf(frame.x))
		for frame in touch.mix_audio(1.0, 735):
			peaks[1] = maxf(peaks[1], absf(frame.x))
	check("a blow is held within full scale, heard and felt", peaks[0] > 0.1 and peaks[0] <= 1.0 and peaks[1] > 0.5 and peaks[1] <= 1.0, [peaks, world.stats()])
	await gone(world)


func a_world_that_is_built_again_takes_everything_along() -> void:
	var world := made("res://plate.toml")
	var collider := table()
	var body: AsperityBody = collider.get_node("Table")
	var finger := finger_above()
	for tick in 30:
		finger.position.x = -0.1 + 0.003 * tick
		await physics_frame
	check("a finger touches before", finger.is_touching(), world.last_error())
	var told := heard.sentences.size()
	var old_plate := world.find_surface("plate")
	check("a world is built a second time", world.build(), world.last_error())
	check("its bodies are in the new engine", body.body_id() != 0 and world.find_body("Table") == body.body_id() and world.find_surface("Table") == body.surface_id())
	check("the file's are too", world.find_surface("plate") != 0, old_plate)
	await physics_frame
	taken("Sound")
	taken("Haptics")
	for tick in 60:
		finger.position.x = -0.1 + 0.003 * tick
		await physics_frame
	check("the finger goes on", finger.is_touching() and world.stats().contacts == 1, world.stats())
	check("the world's buses play the new engine", rms(taken("Sound"), 0) > 1e-6 and rms(taken("Haptics"), 0) > 1e-4)
	check("a blow rings", world.report_impact(body.body_id(), 1, 0.01, 0.005, "steel", 0) and world.stats().refused == 0, world.last_error())
	check("nothing is said of what was before", heard.sentences.size() == told, heard.sentences.slice(told))
	check("the old engine's players are gone", world.get_child_count() == 2, world.get_child_count())
	world.scene_file = ""
	check("and again, without the file", world.build() and world.find_surface("plate") == 0 and body.body_id() != 0)
	root.remove_child(collider)
	check("a body leaves the engine that it is in", world.find_body("Table") == 0)
	finger.queue_free()
	collider.queue_free()
	await gone(world)


func a_scene_is_freed_while_it_plays() -> void:
	for round in 5:
		var world := made("res://plate.toml")
		var plate := world.find_surface("plate")
		world.report_begin(1, plate, Vector2(0.2, 0.5), 0.6, 0)
		for tick in 5 + round:
			await physics_frame
			world.report_move(1, Vector2(0.2 + 0.01 * tick, 0.5), 0.6)
		# Now, not at the end of the frame; and the streams outlive it.
		var kept := world.audio_stream()
		world.free()
		await physics_frame
		kept = null
	for frame in 30:
		await physics_frame
	check("a scene that is freed while it plays does not crash", true)
