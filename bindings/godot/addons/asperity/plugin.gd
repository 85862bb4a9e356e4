# The classes come with the extension; the editor needs nothing more. It is a plugin so that the project's settings list it.
@tool
extends EditorPlugin
