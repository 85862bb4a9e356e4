# Every error that Godot is told, as a list of sentences.
extends Logger

var sentences: Array[String] = []
var mutex := Mutex.new()


func _log_error(_function, _file, _line, code, rationale, _editor, _type, _traces) -> void:
	mutex.lock()
	sentences.append(rationale if rationale else code)
	mutex.unlock()


func has(part: String) -> bool:
	mutex.lock()
	var found := sentences.any(func(sentence): return part in sentence)
	mutex.unlock()
	return found
