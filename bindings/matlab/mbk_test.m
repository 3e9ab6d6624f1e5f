% The package +mbk in Octave: what it gives is what the program gives, to the last bit.
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

function check_alike(a, b, what)
  check(numel(a) > 3 && isequal(size(a), size(b)) && isequal(num2hex(a(:)), num2hex(b(:))), what);
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
check_error(@() mbk.measure(log_file, 'sg_window', 100), 'mbk:usage', 'odd', 'an even window');
check_error(@() mbk.measure(log_file, 'cutof', 5), 'mbk:usage', 'cutoff', 'an unknown option');
check_error(@() mbk.measure('none.mat'), 'mbk:data', 'none.mat', 'no such file');
check_error(@() mbk.measure(recording.time, x(1:10, :), F), 'mbk:usage', '10 x 2', 'a short array');
check_error(@() mbk.measure(struct('time', recording.time, 'x', {{1}})), 'mbk:usage', 'cell', 'no numbers');
check_error(@() mbk.measure(struct('time', [], 'x', [], 'F', [])), 'mbk:data', 'empty', 'no samples');
check_error(@() mbk.measure(recording.time, 1i * x, F), 'mbk:usage', 'real', 'complex numbers');

% Other classes and units are converted, and no number is lost on the way.
whole = struct('time', recording.time, 'x', single(1000 * recording.hand_x), 'F', recording.force_x);
whole.units = struct('x', 'mm');
converted = mbk.identify(whole, 'axes', 1);
check(isequal(size(converted.model.K), [1 1]), 'single precision in mm');

% What looks like iddata.
data = struct('OutputData', recording.hand_x, 'InputData', recording.force_x, 'Ts', 1e-3, 'OutputName', {{'x'}}, ...
              'InputName', {{'F'}}, 'OutputUnit', {{'m'}}, 'InputUnit', {{'N'}});
identified = mbk.identify(data, 'axes', 1);
direct = mbk.identify(struct('time', (0:numel(recording.time) - 1)' * 1e-3, 'x', recording.hand_x, ...
                             'F', recording.force_x), 'axes', 1);
check_alike(numbers_of(identified), numbers_of(direct), 'iddata');

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
evalc('poor = mbk.measure(struct(''time'', recording.time, ''x'', recording.hand_x, ''F'', randn(size(recording.time))), ''axes'', 1);');
[~, identifier] = lastwarn();
check(strncmp(identifier, 'mbk:', 4), ['a warning: ' identifier]);
warning('off', 'all');

% Help and plots.
check(~isempty(strfind(evalc('help mbk.measure'), 'NAME, VALUE')), 'help');
figure_number = figure('visible', 'off');
handles = mbk.plot(result);
check(numel(handles) == 4, 'a plot of each matrix, and one over frequency');
for k = 1:numel(handles)
  check(~isempty(get(get(handles(k), 'xlabel'), 'string')), 'labelled axes');
end
if ~isempty(getenv('MBK_PICTURE'))
  print(figure_number, getenv('MBK_PICTURE'), '-dpng', '-S900,700');
end
close(figure_number);

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
