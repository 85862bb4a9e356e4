# Tests of hands: a tracked tip in, the controller of a headset and a joypad out.
extends "surfaces.gd"

const Headset := preload("fake_headset.gd")


# A table whose top lies at its body's own height 0, u along x and v along -z; out of it is up.
func framed_table() -> StaticBody3D:
	var ground := table()
	var body: AsperityBody = ground.get_node("Table")
	ground.remove_child(body)
	body.surface.table = "frame = { origin_m = [-0.15, 0.0, 0.15], u_axis = [1.0, 0.0, 0.0], v_axis = [0.0, 0.0, -1.0] }"
	ground.add_child(body)
	return ground


func tip_over(ground: Node) -> AsperityTip3D:
	var tip := AsperityTip3D.new()
	tip.body = ground.get_node("Table")
	tip.position.y = 0.05
	root.add_child(tip)
	return tip


# So many ticks of a hand that comes down to 5 mm below the top at 0.3 m/s, and goes along it at 0.1 m/s.
func follow(tip: AsperityTip3D, ticks: int) -> void:
	for tick in ticks:
		tip.position = tip.get_meta("ground", Vector3.ZERO) + Vector3(-0.1 + 0.1 * tick / 60.0, maxf(0.05 - 0.3 * tick / 60.0, -0.005), 0.02)
		await physics_frame


func a_tracked_tip_presses_with_stiffness_times_depth() -> void:
	var world := made("", "Sound", "Haptics")
	var ground := framed_table()
	# The body's own axes count: the table stands elsewhere, and turned.
	ground.position = Vector3(1.0, 0.5, -2.0)
	var tip := tip_over(ground)
	tip.set_meta("ground", ground.position)
	await physics_frame
	check("a tip in the air touches nothing", tip.normal_force_n() == 0.0 and world.stats().contacts == 0)
	await follow(tip, 80)
	check("it presses with 200 N/m times 5 mm", absf(tip.normal_force_n() - 1.0) < 0.01, tip.normal_force_n())
	check("it is one contact", world.stats().contacts == 1 and world.stats().refused == 0, world.stats())
	var touch := taken("Haptics")
	check("it is felt and heard", rms(touch, 0) > 1e-5 and rms(taken("Sound"), 0) > 1e-6, rms(touch, 0))
	tip.position.y += -0.5
	for tick in 3:
		await physics_frame
	check("its force is bounded", tip.normal_force_n() == 5.0, tip.normal_force_n())
	tip.tracked = false
	for tick in 20:
		await physics_frame
	check("a hand that is lost lifts", tip.normal_force_n() == 0.0 and world.stats().contacts == 0, world.stats())
	tip.tracked = true
	await follow(tip, 60)
	world.build()
	await follow(tip, 60)
	check("it goes on in a world that is built anew", tip.normal_force_n() > 0.9 and world.stats().contacts == 1, world.stats())
	tip.queue_free()
	for tick in 20:
		await physics_frame
	check("a tip that is freed lifts", world.stats().contacts == 0)
	ground.queue_free()
	await gone(world)


func a_tip_over_a_surface_without_a_frame_says_so() -> void:
	var world := made("", "Sound", "")
	var ground := table()
	var tip := tip_over(ground)
	await follow(tip, 10)
	check("a surface without a frame is told", heard.has("AsperityTip3D") and heard.has("frame"))
	tip.queue_free()
	ground.queue_free()
	await gone(world)


func a_stroke_is_felt_on_a_headset_and_a_joypad() -> void:
	var headset := Headset.new()
	XRServer.add_interface(headset)
	XRServer.primary_interface = headset
	var world := made("", "Sound", "")
	var haptics := AsperityHaptics.new()
	haptics.tracker = "right_hand"
	haptics.joypad = 3
	haptics.full_scale = 0.1
	root.add_child(haptics)
	for frame in 20:
		await physics_frame
	check("nothing vibrates without a touch", headset.pulses.is_empty() and Input.get_joy_vibration_strength(3) == Vector2.ZERO)
	var ground := framed_table()
	var tip := tip_over(ground)
	var motors := Vector2.ZERO
	for part in 2:
		await follow(tip, 60)
		motors = motors.max(Input.get_joy_vibration_strength(3))
	var pulses: Array = headset.pulses
	# Without a sound card Godot mixes 4096 frames at once: a pulse each 93 ms there, 21 in two seconds.
	check("a controller gets a pulse each 30 ms or as often as sound is mixed", pulses.size() > 15 and pulses.size() < 80, pulses.size())
	var right := func(pulse: Dictionary) -> bool:
		return pulse.action == "haptic" and pulse.tracker == &"right_hand" and pulse.duration_s > 0.03 and pulse.amplitude > 0.0 and pulse.amplitude <= 1.0 and pulse.frequency >= 55.0 and pulse.frequency <= 200.0
	check("each has its action, tracker, level and tone", pulses.all(right), pulses.front())
	check("a joypad's motors turn", motors.x > 0.01 or motors.y > 0.01, motors)
	tip.queue_free()
	for frame in 40:
		await physics_frame
	var count := pulses.size()
	for frame in 20:
		await physics_frame
	check("they stop with the touch", pulses.size() == count and Input.get_joy_vibration_strength(3) == Vector2.ZERO)
	haptics.queue_free()
	ground.queue_free()
	await gone(world)
	XRServer.primary_interface = null
	XRServer.remove_interface(headset)
