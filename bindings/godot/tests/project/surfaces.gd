# What materials give to be felt, and how a finger feels the meshes that wear them.
extends "harness.gd"


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
		var collider := table(material)
		var finger := finger_above()
		finger.position.x = -0.12
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
