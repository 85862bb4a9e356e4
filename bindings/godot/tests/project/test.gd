# The add-on in a real Godot: `godot --headless --path . --script test.gd`. Ends with a summary line, and code 1 where something failed.
extends "hands.gd"


func _initialize() -> void:
	listen()
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
	await a_tracked_tip_presses_with_stiffness_times_depth()
	await a_tip_over_a_surface_without_a_frame_says_so()
	await a_stroke_is_felt_on_a_headset_and_a_joypad()
	await what_rolls_is_softer_than_what_slides()
	await a_strike_gain_turns_blows_down()
	await a_blow_sounds_as_where_it_lands()
	await a_blow_that_is_felt_stays_within_full_scale()
	await a_world_that_is_built_again_takes_everything_along()
	await a_scene_is_freed_while_it_plays()
	OS.remove_logger(heard)
	print("%d passed, %d failed" % [passed, failed])
	quit(1 if failed else 0)


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
	# Godot's own hitches under load tie it anew; nothing else does.
	check("the clock jumps at a hitch at most", stats.clock_jumps <= 2, stats)
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
	var crate := world.add_probe("preset = \"rigid\"\nface_m = 0.4", "crate")
	check("a crate's probe can be added", crate != 0, world.last_error())
	check("a face of no length that is one is refused", world.add_probe("face_m = -1.0", "") == 0 and "face_m" in world.last_error(), world.last_error())
	var second := world.add_surface(surface, 0, "second")
	check("a contact can be a crate's", world.report_begin(3, second, Vector2.ZERO, 0.5, -1, NAN, NAN, Vector2(NAN, NAN), crate), world.last_error())
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


# A strip of 1 m whose only mode moves as the cosine of half a turn along it.
func write_strip(path: String) -> void:
	var points := []
	var motion := []
	var triangles := []
	for step in 17:
		for side in 2:
			points.append([step / 16.0, 0.01, 0.1 * side])
			motion.append([0.0, cos(PI * step / 16.0), 0.0])
		if step < 16:
			var a := 2 * step
			triangles.append([a, a + 1, a + 2])
			triangles.append([a + 1, a + 3, a + 2])
	var mode := {"frequency_hz": 400.0, "decay_per_s": 5.0, "amplitude": 0.01, "phase_rad": PI / 2}
	var shapes := {"points_m": points, "triangles": triangles, "gains": [0.01], "phi_per_sqrt_kg": [motion], "struck_point": 0}
	var file := FileAccess.open(path, FileAccess.WRITE)
	file.store_string(JSON.stringify({"format": "asperity.modes", "version": 2, "unit": "relative", "modes": [mode], "shapes": shapes}))
	file.close()


func a_blow_sounds_as_where_it_lands() -> void:
	write_strip("user://strip.modes.json")
	var peaks := []
	for x in [0.0, 0.25, 0.5]:
		var world := made("", "", "")
		var sound := world.audio_stream().instantiate_playback()
		var body := AsperityBody.new()
		body.modes_file = "user://strip.modes.json"
		world.add_child(body)
		check("it is struck at %.2f m" % x, world.report_impact(body.body_id(), 0.5, 0.01, 0.005, "steel", -1, Vector3(x, 0.01, 0.05)), world.last_error())
		var peak := 0.0
		for tick in 10:
			await physics_frame
			for frame in sound.mix_audio(1.0, 735):
				peak = maxf(peak, absf(frame.x))
		peaks.append(peak)
		await gone(world)
	var halfway_db := 20 * log(peaks[1] / peaks[0]) / log(10)
	check("a blow sounds as where it lands", peaks[0] > 1e-9 and absf(halfway_db + 3.01) < 0.1 and peaks[2] < 0.01 * peaks[0], "%.2f dB, %s" % [halfway_db, peaks])


func a_strike_gain_turns_blows_down() -> void:
	var peaks := []
	for strike_gain in [-1.0, 0.25]:
		var world := as_given()
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


# Without a scene file levels are found: strokes are within full scale by themselves, blows by limiters at most.
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
