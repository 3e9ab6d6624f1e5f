function texts = option_texts(given)
% Converts names and values of options to texts: {'sg-window', '101', ...}.
  if numel(given) == 1 && isstruct(given{1})
    names = fieldnames(given{1});
    given = [names'; struct2cell(given{1})'];
    given = given(:)';
  end
  if mod(numel(given), 2) ~= 0
    error('mbk:usage', 'an option has no value; give names and values in pairs');
  end
  texts = {};
  for k = 1:2:numel(given)
    name = strrep(char(given{k}), '_', '-');
    value = given{k + 1};
    if isempty(value) && ~ischar(value)
      continue  % ignored
    elseif islogical(value) && isscalar(value)
      if value || strcmp(name, 'json')
        words = {'true', 'false'};
        texts(end + 1:end + 2) = {name, words{2 - value}};
      end
    elseif isnumeric(value)
      for i = 1:numel(value)
        texts(end + 1:end + 2) = {name, sprintf('%.17g', value(i))};
      end
    elseif iscell(value)
      for i = 1:numel(value)
        texts(end + 1:end + 2) = {name, char(value{i})};
      end
    else
      texts(end + 1:end + 2) = {name, char(value)};
    end
  end
end
