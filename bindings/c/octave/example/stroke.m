% A finger strokes a granite plate for a second: what is heard and felt goes into stroke.wav, and is told.
scene = fullfile(tempdir, 'plate.toml');
file = fopen(scene, 'w');
fprintf(file, '%s\n', ...
    'sample_rate_hz = 48000', ...
    '[[body]]', 'name = "plate"', 'stock = "plate"', 'size_m = 0.14', 'material = "stone"', ...
    '[[surface]]', 'name = "top"', 'body = "plate"', 'solid = "granite"', 'width_m = 0.14', 'height_m = 0.14');
fclose(file);

log = '';
for t = 0:0.01:1
    event = struct('t', t, 'event', 'move', 'contact', 1, 'uv', [0.1 + 0.7 * t, 0.5], 'normal_force_n', 0.6);
    if t == 0
        event.event = 'begin';
        event.surface = 'top';
        event.actuator = 0;
    end
    log = [log, jsonencode(event), newline];
end
log = [log, jsonencode(struct('t', 1.01, 'event', 'end', 'contact', 1)), newline];

[audio, haptic, rate_hz] = asperity_render(scene, log, 1.0);   % a column a bus, a column an actuator
audiowrite('stroke.wav', [audio(:, 1), haptic(:, 1)], rate_hz);
fprintf('heard %.3g, felt %.3g, %.1f s at %d Hz\n', max(abs(audio(:, 1))), max(abs(haptic(:, 1))), size(audio, 1) / rate_hz, rate_hz);
