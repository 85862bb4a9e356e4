% The MEX function gives the samples of the C program, and the library's sentence when something is wrong.
arguments = argv();
folder = arguments{end - 1};
raw = arguments{end};
log = fileread(fullfile(folder, 'replay.jsonl'));
[audio, haptic, rate_hz] = asperity_render(fullfile(folder, 'replay.toml'), log, 0.5);
file = fopen(raw);
samples = fread(file, inf, 'float32');
fclose(file);
samples = reshape(samples, rows(audio), []);
assert(rate_hz == 44100 && columns(haptic) == 2 && columns(audio) == 2);
assert(isequal([haptic, audio], samples));
try
    asperity_render('nowhere.toml', log);
    error('nothing was refused');
catch refusal
    assert(! isempty(strfind(refusal.message, 'nowhere.toml: no such file')), refusal.message);
end
printf('Octave: the samples of the C program, and its sentences\n');
