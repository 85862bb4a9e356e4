# An XR interface without a headset, which notes every pulse.
extends XRInterfaceExtension

var pulses := []


func _get_name() -> StringName:
	return &"Fake"


func _is_initialized() -> bool:
	return true


func _trigger_haptic_pulse(action: String, tracker: StringName, frequency: float, amplitude: float, duration_s: float, _delay_s: float) -> void:
	pulses.append({ "action": action, "tracker": tracker, "frequency": frequency, "amplitude": amplitude, "duration_s": duration_s })
