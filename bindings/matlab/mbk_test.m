% The package +mbk in Octave: results equal those of the program, to the last bit.
1;

function check(condition, what)
  global failures
  if ~condition
    printf('FAILED: %s\n', what);
    failures = failures + 1;
  end
end

function text = program(arguments)
  [~, text] = system([getenv('MBK') ' ' arguments ' 2> /dev/null']);
end

% Every number of a document by its text, in order.
function numbers = numbers_in(document)
  document = regexprep(document, '"(\\.|[^"\\])*"', '');
  words = regexp(document, '-?\d+(\.\d+)?([eE][-+]?\d+)?', 'match');
  numbers = cellfun(@(word) sscanf(word, '%f'), words);
end

% Every number of a value that was decoded, in the order of the document.
function numbers = numbers_of(value)
  numbers = [];
  if isnumeric(value)
    value = value';  % a matrix is written row by row
    numbers = value(:)';
    numbers = numbers(~isnan(numbers));
  elseif iscell(value)
    for k = 1:numel(value)
      numbers = [numbers, numbers_of(value{k})];
    end
  elseif isstruct(value)
    for k = 1:numel(value)
      names = fieldnames(value);
      for f = 1:numel(names)
        numbers = [numbers, numbers_of(value(k).(names{f}))];
      end
    end
  end
end

function check_error(work, identifier, word, what)
  try
    work();
    check(false, [what ': no error']);
  catch error
    check(strcmp(error.identifier, identifier), [what ': ' error.identifier]);
    check(~isempty(strfind(error.message, word)), [what ': ' error.message]);
  end
end

% The error names options and commands as MATLAB writes them: 'rate', 1000 for --rate 1000.
function check_matlab(work, word)
  try
    work();
    check(false, ['no error that names ' word]);
  catch error
    check(~isempty(strfind(error.message, word)), [word ' is missing: ' error.message]);
    check(~has_shell_words(error.message), ['an option of the command line: ' error.message]);
  end
end

function yes = has_shell_words(text)
  text = regexprep(text, '''mbk [^'']*'' in a terminal', '');
  yes = ~isempty(regexp(text, '(^|[^\w./-])--[a-z]|''mbk ', 'once'));
end

function check_alike(a, b, what)
  check(numel(a) > 3 && isequal(size(a), size(b)) && isequal(num2hex(a(:)), num2hex(b(:))), what);
end

function check_near(a, b, what)
  check(numel(a) >= 3 && isequal(size(a), size(b)) && all(abs(a - b) <= 1e-9 * max(abs(b))), what);
end

function numbers = model_of(data, varargin)
  result = mbk.identify(data, 'axes', 1, varargin{:});
  numbers = numbers_of(result.model);
end

% What the line of that colour shows.
function y = shown(handle, colour)
  lines = findobj(handle, 'type', 'line', 'color', colour);
  y = get(lines(1), 'ydata');
  y = y(:);
end

function check_labelled(handles, count, what)
  check(numel(handles) == count, sprintf('%s: %d axes', what, numel(handles)));
  for k = 1:numel(handles)
    check(~isempty(get(get(handles(k), 'ylabel'), 'string')), [what ': labelled axes']);
  end
  check(~isempty(get(get(handles(end), 'xlabel'), 'string')), [what ': labelled axes']);
end

function keep_picture(name)
  if ~isempty(getenv('MBK_PICTURES'))
    print(gcf(), fullfile(getenv('MBK_PICTURES'), [name '.png']), '-dpng', '-S900,700');
  end
  clf();
end

global failures
failures = 0;
addpath(getenv('MBK_OCTAVE'));
warning('off', 'all');
graphics_toolkit('gnuplot');
folder = tempname();
mkdir(folder);
log_file = fullfile(folder, 'log.mat');
program(['simulate relaxed_sinusoidal --out ' log_file]);

% A file.
warning('off', 'all');
[result, info] = mbk.measure(log_file);
document = program(['measure --json ' log_file]);
check(strcmp(info.text, document), 'the document is that of the program');
check_alike(numbers_of(result), numbers_in(document), 'every number is that of the document');
check(strcmp(result.schema, 'mbk.result/2') && result.usable, 'the struct has what the document has');
check(isequal(size(result.model.K), [2 2]) && isequal(size(result.model.x0), [2 1]), 'matrices are matrices');
check(info.exit_code == 0, 'the exit code');

% What was read, as arrays: the same numbers, to the bit.
recording = mbk.read(log_file);
check(numel(recording.time) == numel(recording.hand_x) && strcmp(recording.units.force_x, 'N'), 'read');
from_struct = mbk.measure(recording);
check_alike(numbers_of(from_struct.model), numbers_of(result.model), 'from a struct');
x = [recording.hand_x, recording.hand_y];
F = [recording.force_x, recording.force_y];
xr = [recording.reference_x, recording.reference_y];
from_arrays = mbk.measure(recording.time, x, F, xr, 'acceleration', 'derivative', 'handle_mass', 0);
same = mbk.measure(log_file, 'acceleration', 'derivative', 'handle_mass', 0);
check_alike(numbers_of(from_arrays.model), numbers_of(same.model), 'from arrays');

% Options by their names, with the checks of the command line.
from_options = mbk.identify(log_file, 'mode', 'reference', 'sg_window', 151, 'ignore_range', {'stiffness', 'motion'});
expected = program(['identify --json --mode reference --sg-window=151 --ignore-range stiffness,motion ' log_file]);
check_alike(numbers_of(from_options), numbers_in(expected), 'options');
check_error(@() mbk.measure(log_file, 'sg_window', 100), 'mbk:usage', '100', 'an even window');
check_error(@() mbk.measure(log_file, 'cutof', 5), 'mbk:usage', 'cutoff', 'an unknown option');
check_error(@() mbk.measure('none.mat'), 'mbk:data', 'none.mat', 'no such file');
check_error(@() mbk.measure(recording.time, x(1:10, :), F), 'mbk:usage', '10 x 2', 'a short array');
check_error(@() mbk.measure(struct('time', recording.time, 'x', {{1}})), 'mbk:usage', 'cell', 'no numbers');
check_error(@() mbk.measure(struct('time', [], 'x', [], 'F', [])), 'mbk:data', '''time''', 'no samples');
check_error(@() mbk.measure(recording.time, 1i * x, F), 'mbk:usage', 'numbers', 'complex numbers');

% Errors name arguments of MATLAB functions.
unnamed = struct('time', recording.time, 'u', recording.hand_x, 'v', recording.force_x);
without_time = struct('x', recording.hand_x, 'F', recording.force_x);
cases = {@() mbk.measure(log_file, 'mode', 'fast'), 'mode: '
         @() mbk.measure(log_file, 'sg_window', 4), '''help mbk.measure'''
         @() mbk.measure(log_file, 'trial', 7), '''trial'', 7'
         @() mbk.measure(log_file, 'from', 500), '''from'''
         @() mbk.measure(log_file, 'split', 500), '''split'', 500'
         @() mbk.measure(log_file, 'cutoff', 900), '''cutoff'''
         @() mbk.measure(log_file, 'procedure', 'chapter3'), '''mode'', ''reference'''
         @() mbk.measure(log_file, 'channels', 'x'), '''channels'', ''x='
         @() mbk.measure(unnamed), '''channels'', ''time='
         @() mbk.measure(without_time), '''rate'', 1000'
         @() mbk.measure(recording, 'parts', true), '''parts'', true'
         @() mbk.tf(log_file, 'input', 'Fx', 'output', 'x'), '''poles'', 4, ''zeros'', 3'
         @() mbk.simulate('relaxed_sinusoidal', 'out', log_file), '''overwrite'', true'
         @() mbk.simulate('no_such_scenario'), '''out'', ''recording.mat'''
         @() mbk.simulate('no_such_scenario', 'out', fullfile(folder, 'a.mat')), 'mbk.simulate(''list'', true)'
         @() mbk.study('list', {}, 'study', fullfile(folder, 'nowhere')), 'mbk.study(''init'', FOLDER)'
         @() mbk.sensor('delay', log_file), '''help mbk.sensor'''};
for k = 1:rows(cases)
  check_matlab(cases{k, :});
end

% Other classes and units are converted, and no number is lost on the way.
whole = struct('time', recording.time, 'x', single(1000 * recording.hand_x), 'F', recording.force_x);
whole.units = struct('x', 'mm');
converted = mbk.identify(whole, 'axes', 1);
check(isequal(size(converted.model.K), [1 1]), 'single precision in mm');

% Objects that MATLAB has; here others stand in for them. iddata and a struct with its fields, short names or long.
addpath(fullfile(pwd(), 'stand_ins'));
x = recording.hand_x;
force = recording.force_x;
direct = mbk.identify(struct('time', (0:numel(x) - 1)' * 1e-3, 'x', x, 'F', force), 'axes', 1);
data = iddata();
data.OutputData = 1000 * x;
data.InputData = force;
data.Ts = 1;
data.Tstart = 0;
data.TimeUnit = 'milliseconds';
data.OutputName = {'x'};
data.InputName = {'F'};
data.OutputUnit = {'mm'};
data.InputUnit = {'N'};
check_near(model_of(data), numbers_of(direct.model), 'iddata');
short = struct('y', x, 'u', force, 'Ts', 1e-3);
check_near(model_of(short, 'channels', 'x=y1,F=u1'), numbers_of(direct.model), 'y, u and Ts');
check_error(@() mbk.identify(short, 'axes', 1), 'mbk:data', 'y1', 'y and u, not said which is which');
data.OutputData = {x, x};
check_error(@() mbk.identify(data, 'axes', 1), 'mbk:usage', 'getexp', 'several experiments');
data.OutputData = x;
data.Domain = 'Frequency';
check_error(@() mbk.identify(data, 'axes', 1), 'mbk:usage', 'frequency', 'frequencies');
data.Domain = 'Time';
data.TimeUnit = 'years';
check_error(@() mbk.identify(data, 'axes', 1), 'mbk:usage', 'years', 'a unit of time');
data.TimeUnit = 'seconds';
data.Ts = [];
check_error(@() mbk.identify(data, 'axes', 1), 'mbk:usage', 'Ts', 'no sample time');
steps = (0:numel(x) - 1)';
columns = struct('x', 1000 * x, 'F', force);
timed = timetable(duration(steps), columns, {'mm', 'N'});
check_near(model_of(timed), numbers_of(direct.model), 'timetable');
timed = timetable(datetime(1.7e12 + steps), columns, {'mm', 'N'});
check_near(model_of(timed), numbers_of(direct.model), 'a timetable with dates');
columns = struct('hand', [x, recording.hand_y], 'force', [force, recording.force_y]);
timed = timetable(duration(steps), columns, {});
found = mbk.identify(timed, 'channels', 'x=hand_1,y=hand_2,Fx=force_1,Fy=force_2');
check(isequal(size(found.model.K), [2 2]), 'a timetable with several columns in a variable');
timed = timetable(duration(steps), struct('x', {num2cell(x)}, 'F', force), {});
check_error(@() mbk.identify(timed, 'axes', 1), 'mbk:usage', 'cell', 'a column of cells');
untimed = table(struct('time', 1e-3 * steps, 'x', 1000 * x, 'F', force), {'s', 'mm', 'N'});
check_near(model_of(untimed), numbers_of(direct.model), 'table');
untimed = table(struct('x', x, 'F', force), {});
check_near(model_of(untimed, 'rate', 1000), numbers_of(direct.model), 'a table without time and a rate');
check_error(@() mbk.identify(untimed, 'axes', 1), 'mbk:data', 'rate', 'a table without time');

% A struct with y, u and Ts: rows or columns, names and units; mismatches are errors.
short = struct('y', 1000 * x', 'u', force', 'Ts', 1e-3, 'OutputName', 'x', 'InputName', 'F', 'OutputUnit', 'mm');
check_near(model_of(short), numbers_of(direct.model), 'rows with names and a unit');
both = struct('y', [x, recording.hand_y], 'u', [force, recording.force_y], 'Ts', 1e-3);
found = mbk.identify(both, 'channels', 'x=y1,y=y2,Fx=u1,Fy=u2');
check(isequal(size(found.model.K), [2 2]), 'two outputs and two inputs');
for step = {0, -1e-3, NaN, Inf, [1e-3 1e-3], '1 ms'}
  short.Ts = step{1};
  check_error(@() mbk.identify(short, 'axes', 1), 'mbk:usage', 'Ts', 'a sample time that is none');
end
short.Ts = 1e-3;
short.u = force(1:end - 1);
check_error(@() mbk.identify(short, 'axes', 1), 'mbk:data', 'samples', 'fewer inputs than outputs');
short.u = 1i * force;
check_error(@() mbk.identify(short, 'axes', 1), 'mbk:usage', 'numbers', 'complex inputs');
bad = force;
bad(100) = NaN;
short.u = bad;
check_error(@() mbk.identify(short, 'axes', 1), 'mbk:data', 'sample 100', 'a gap');

% Results as input of other commands.
verdict = mbk.passivity(info);
file = fullfile(folder, 'result.json');
program(['measure --json ' log_file ' --out ' file]);
check_alike(numbers_of(verdict), numbers_in(program(['passivity --json ' file])), 'passivity of a result');
widths = mbk.compare(info, info);
check(strcmp(widths.schema, 'mbk.compare/1'), 'compare');
text = mbk.convert({log_file, fullfile(folder, 'log.h5')});
check(~isempty(strfind(text, 'HDF5')) && exist(fullfile(folder, 'log.h5'), 'file') == 2, 'convert');
facts = mbk.info(log_file);
check(strcmp(facts.schema, 'mbk.info/1'), 'info');

% A warning has the code of the document.
warning('on', 'all');
lastwarn('', '');
evalc('[poor, poor_info] = mbk.measure(struct(''time'', recording.time, ''x'', recording.hand_x, ''F'', randn(size(recording.time))), ''axes'', 1);');
[~, identifier] = lastwarn();
check(strncmp(identifier, 'mbk:', 4), ['a warning: ' identifier]);
for k = 1:numel(poor_info.warnings)
  check(~has_shell_words(poor_info.warnings(k).message), ['a warning: ' poor_info.warnings(k).message]);
end
warning('off', 'all');

% Help and plots.
check(~isempty(strfind(evalc('help mbk.measure'), 'NAME, VALUE')), 'help');
figure('visible', 'off');
blue = mbk.internal.style('first');
orange = mbk.internal.style('second');
check_labelled(mbk.plot(result), 4, 'a plot of each matrix, and one over frequency');
keep_picture('ellipses');
check_labelled(mbk.plot(direct), 4, 'one axis');
keep_picture('one_axis');
absorbed = mbk.passivity(log_file);
handles = mbk.plot(absorbed);
check_labelled(handles, 2, 'energy');
check(isequal(shown(handles(1), blue), absorbed.recordings.absorbed_J), 'the energy that was absorbed');
keep_picture('energy');
check_labelled(mbk.plot_energy(result), 1, 'the energy of a result');
keep_picture('energy_of_result');
explored = mbk.explore(log_file, 'only', 'frequency-response');
handles = mbk.plot(explored);
response = explored.frequency_response.responses(1);
check(numel(handles) == 3 * numel(explored.frequency_response.responses), 'Bode of each input and output');
check_labelled(handles(1:3), 3, 'Bode');
check(isequal(shown(handles(1), blue), response.magnitude), 'a magnitude');
check(isequal(shown(handles(2), blue), response.phase_deg), 'a phase');
keep_picture('bode');
fitted = mbk.tf(log_file, 'input', '-Fx', 'output', 'x', 'poles', 2, 'zeros', 0);
handles = mbk.plot(fitted);
check_labelled(handles, 2, 'Bode of a transfer function');
check(isequal(shown(handles(1), blue), fitted.frequency_response.magnitude), 'its magnitude');
keep_picture('tf');
handles = mbk.plot_fit(log_file, struct('handle_mass', 0));
check_labelled(handles, 4, 'the fit');
measured = shown(handles(1), mbk.internal.style('other'));
residual = shown(handles(2), blue);
left = measured - shown(handles(1), orange) - residual;  % of numbers that a report rounds
check(max(abs(left)) < 0.01 * std(residual) && std(residual) < 0.2 * std(measured), 'the fit');
keep_picture('fit');
close();
check_error(@() mbk.plot(facts), 'mbk:usage', 'plot', 'no plot of facts');
check_error(@() mbk.plot_energy(facts), 'mbk:usage', 'passivity', 'no energy of facts');

% Ctrl-C ends a call that would go on for hours, with an error.
begun = fullfile(folder, 'begun');
script = ['addpath(''' getenv('MBK_OCTAVE') '''); warning(''off'', ''all''); fclose(fopen(''' begun ''', ''w'')); ' ...
          'try; mbk.validate(''coverage'', ''runs'', 1000000); catch e; disp(e.identifier); end'];
[~, said] = system(sprintf(['timeout --foreground --signal=KILL 60 "%s" --no-gui -q -f --eval "%s" 2>&1 & octave=$!; ' ...
                            'while [ ! -e "%s" ]; do sleep 0.1; done; sleep 1; kill -INT $octave; wait $octave'], ...
                           fullfile(OCTAVE_HOME(), 'bin', 'octave-cli'), script, begun));
check(~isempty(strfind(said, 'mbk:stopped')), ['Ctrl-C: ' said]);

% Nothing leaks.
short = struct('time', recording.time(1:3000), 'x', recording.hand_x(1:3000), 'F', recording.force_x(1:3000));
function kilobytes = resident()
  kilobytes = sscanf(regexp(fileread('/proc/self/status'), 'VmRSS:\s*(\d+)', 'tokens', 'once'){1}, '%d');
end
for k = 1:300
  mbk.info(short);
end
before = resident();
for k = 1:1000
  mbk.info(short);
end
check(resident() - before < 1024, sprintf('1000 calls took %d kB', resident() - before));

confirm_recursive_rmdir(false);
rmdir(folder, 's');
if failures > 0
  exit(1);
end
